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
