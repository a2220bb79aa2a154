"""Finding a near-horizontal plane among points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray

N_HYPOTHESES = 200
N_VOTERS = 4000
"""Points that vote for a hypothesis; the least squares after it use all."""
N_REFINEMENTS = 5
STEEPEST_RAD = np.deg2rad(10.0)
INLIER_DISTANCE_M = 0.006
"""Twice the depth noise of a structured-light camera at 0.7 m."""


@dataclass(frozen=True)
class Plane:
    """A plane through `point_m` (3,) with the upward unit `normal` (3,); `share` of the points lies on it."""

    point_m: FloatArray
    normal: FloatArray
    share: float

    @property
    def tilt_rad(self) -> float:
        """Angle between the normal and the vertical."""
        return float(np.arccos(np.clip(self.normal[2], -1.0, 1.0)))

    def height_m(self, x_m: npt.ArrayLike, y_m: npt.ArrayLike) -> FloatArray:
        """Height z of the plane above (x, y)."""
        dx, dy = np.asarray(x_m) - self.point_m[0], np.asarray(y_m) - self.point_m[1]
        height: FloatArray = self.point_m[2] - (self.normal[0] * dx + self.normal[1] * dy) / self.normal[2]
        return height


def find_plane(points_m: FloatArray, seed: int = 0) -> Plane | None:
    """Return the near-horizontal plane that most of the points (N, 3) lie on; none if there is none.

    RANSAC over seeded samples, then least squares over the inliers.
    """
    if len(points_m) < 3:
        return None
    random = np.random.default_rng(seed)
    corners = points_m[random.integers(len(points_m), size=(N_HYPOTHESES, 3))]
    voters = (
        points_m if len(points_m) <= N_VOTERS else points_m[random.integers(len(points_m), size=N_VOTERS)]
    )
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    is_flat = np.abs(normals[:, 2]) > np.cos(STEEPEST_RAD) * np.maximum(lengths, 1e-9)
    if not is_flat.any():
        return None
    normals, anchors = normals[is_flat] / lengths[is_flat, None], corners[is_flat, 0]
    distances = np.abs(voters @ normals.T - np.einsum("ij,ij->i", anchors, normals))
    best = int((distances < INLIER_DISTANCE_M).sum(axis=0).argmax())
    return _refine(points_m, anchors[best], normals[best])


def _refine(points_m: FloatArray, point_m: FloatArray, normal: FloatArray) -> Plane | None:
    share = 0.0
    for _ in range(N_REFINEMENTS):
        inliers = points_m[np.abs((points_m - point_m) @ normal) < INLIER_DISTANCE_M]
        if len(inliers) < 3:
            return None
        share = len(inliers) / len(points_m)
        point_m = inliers.mean(axis=0)
        normal = np.linalg.svd(inliers - point_m, full_matrices=False)[2][2]
    normal = normal * np.sign(normal[2])
    return Plane(point_m, normal, share) if normal[2] > np.cos(STEEPEST_RAD) else None
