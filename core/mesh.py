"""A triangle mesh as plain arrays: what every stage hands to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray


@dataclass(frozen=True)
class TriangleMesh:
    """Vertices (V, 3) in metres and faces (F, 3) of vertex indices, counter-clockwise from outside."""

    vertices_m: FloatArray
    faces: IntArray

    @property
    def aabb_min_m(self) -> FloatArray:
        """Lower corner (3,) of the axis-aligned bounding box."""
        low: FloatArray = self.vertices_m.min(axis=0)
        return low

    @property
    def aabb_max_m(self) -> FloatArray:
        """Upper corner (3,) of the axis-aligned bounding box."""
        high: FloatArray = self.vertices_m.max(axis=0)
        return high

    @property
    def extents_m(self) -> FloatArray:
        """Edge lengths (3,) of the axis-aligned bounding box."""
        return self.aabb_max_m - self.aabb_min_m

    @property
    def volume_m3(self) -> float:
        """Signed volume; negative when the faces are turned inside out, meaningful when closed."""
        a, b, c = (self.vertices_m[self.faces[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)

    def translated(self, offset_m: FloatArray) -> TriangleMesh:
        """Return a copy moved by `offset_m` (3,)."""
        return TriangleMesh(self.vertices_m + offset_m, self.faces)

    @property
    def center_of_mass_m(self) -> FloatArray:
        """Centre of mass (3,) at uniform density; the middle of the AABB when the mesh encloses no volume."""
        a, b, c = (self.vertices_m[self.faces[:, k]] for k in range(3))
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        middle: FloatArray = (self.aabb_min_m + self.aabb_max_m) / 2
        if abs(volumes.sum()) < 1e-6 * np.prod(self.extents_m):
            return middle
        center: FloatArray = (volumes[:, None] * (a + b + c) / 4).sum(axis=0) / volumes.sum()
        is_inside = (center >= self.aabb_min_m).all() and (center <= self.aabb_max_m).all()
        return center if is_inside else middle
