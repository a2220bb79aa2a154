"""A triangle mesh as plain arrays, what every stage hands to the next, and distances to its surface."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray

_INSIDE_RAYS = 3
"""Their majority decides what is inside: one may graze an edge."""


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

    @property
    def mean_thickness_m(self) -> float:
        """Mean thickness of the walls of a closed shell, which has two sides; zero without a face."""
        a, b, c = (self.vertices_m[self.faces[:, k]] for k in range(3))
        area_m2 = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
        return 2 * self.volume_m3 / area_m2 if area_m2 > 0 else 0.0

    @property
    def vertex_normals(self) -> FloatArray:
        """Unit normals (V, 3), outward, the adjacent faces' weighted by their area; zero without a face."""
        a, b, c = (self.vertices_m[self.faces[:, k]] for k in range(3))
        areas = np.cross(b - a, c - a)
        normals = np.zeros_like(self.vertices_m)
        for corner in range(3):
            np.add.at(normals, self.faces[:, corner], areas)
        unit: FloatArray = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        return unit

    def translated(self, offset_m: FloatArray) -> TriangleMesh:
        """Return a copy moved by `offset_m` (3,)."""
        return TriangleMesh(self.vertices_m + offset_m, self.faces)

    @property
    def center_of_mass_m(self) -> FloatArray:
        """Centre of mass (3,) at uniform density; the middle of the AABB when the mesh encloses no volume."""
        a, b, c = (self.vertices_m[self.faces[:, k]] for k in range(3))
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        middle: FloatArray = (self.aabb_min_m + self.aabb_max_m) / 2
        if abs(volumes.sum()) <= 1e-6 * np.prod(self.extents_m):
            return middle
        center: FloatArray = (volumes[:, None] * (a + b + c) / 4).sum(axis=0) / volumes.sum()
        is_inside = (center >= self.aabb_min_m).all() and (center <= self.aabb_max_m).all()
        return center if is_inside else middle


class SurfaceDistance:
    """Distances of points to a mesh's surface, in single precision; make it in a worker.

    Open3D, which takes a second to load, is loaded by the first one.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        o3d: Any = import_module("open3d")  # as Any: its stubs do not know numpy's arrays
        self._tensor = o3d.core.Tensor
        self._scene = o3d.t.geometry.RaycastingScene()
        faces = self._tensor(mesh.faces.astype(np.uint32))
        self._scene.add_triangles(self._tensor(mesh.vertices_m.astype(np.float32)), faces)

    def of_m(self, points_m: FloatArray) -> npt.NDArray[np.float32]:
        """Return how far points (N, 3) are off the surface, (N,)."""
        distances: npt.NDArray[np.float32] = self._scene.compute_distance(self._points(points_m)).numpy()
        return distances

    def signed_of_m(self, points_m: FloatArray) -> npt.NDArray[np.float32]:
        """Return the same, negative inside; the mesh is closed."""
        points = self._points(points_m)
        signed: npt.NDArray[np.float32] = self._scene.compute_signed_distance(
            points, nsamples=_INSIDE_RAYS
        ).numpy()
        return signed

    def _points(self, points_m: FloatArray) -> Any:
        return self._tensor(points_m.astype(np.float32))


def surface_difference_m(before: TriangleMesh, after: TriangleMesh) -> FloatArray:
    """Return how far each vertex (V,) of `after` lies off the surface of `before`: positive outside of it.

    Both are closed, in one frame. Call it in a worker.
    """
    return SurfaceDistance(before).signed_of_m(after.vertices_m).astype(float)
