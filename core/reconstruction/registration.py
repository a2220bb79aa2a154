"""How far the views lie from one another: each view's points against the surfaces the other views show.

Points to planes over all pairs of views (Chen & Medioni 1992), all poses moved together. Views are compared
with each other and not with the fused volume, whose walls are thicker as long as the poses err.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.reconstruction.depth_planes import STRIDE, PlaneImage
from core.reconstruction.view_surfaces import ViewSurfaces

SMALLEST_COSINE = 0.8
"""Between two views' directions of one surface: keeps the two sides of a wall apart."""


@dataclass(frozen=True)
class PairSums:
    """Normal equations of points against planes; a view's step is (rotation vector, translation) (6,).

    Attributes:
        matrix: (6 V, 6 V).
        vector: (6 V,).
        square_m2: (V,) sum of the squared distances of a view's points.
        n_matches: (V,) how many they are.
    """

    matrix: FloatArray
    vector: FloatArray
    square_m2: FloatArray
    n_matches: FloatArray

    @property
    def residuals_m(self) -> tuple[float | None, ...]:
        """Root mean square of each view's distances; none where a view meets no other."""
        return tuple(
            float(np.sqrt(square / n)) if n > 0 else None
            for square, n in zip(self.square_m2, self.n_matches, strict=True)
        )

    @property
    def residual_m(self) -> float | None:
        """Root mean square of all distances."""
        n = self.n_matches.sum()
        return float(np.sqrt(self.square_m2.sum() / n)) if n > 0 else None


def compare_views(
    surfaces: ViewSurfaces, poses: FloatArray, center_m: FloatArray, reach_m: float
) -> PairSums:
    """Sum over all pairs; matches farther apart than `reach_m` do not count, near it hardly (Tukey).

    Args:
        surfaces: of all views.
        poses: (V, 4, 4), camera to base.
        center_m: (3,) in the base frame, about which the steps turn.
        reach_m: the largest distance.
    """
    n_views = len(poses)
    points, normals = _in_base(surfaces, poses)
    pairs, vector = np.zeros((n_views, n_views, 6, 6)), np.zeros((n_views, 6))
    square_m2, n_matches = np.zeros(n_views), np.zeros(n_views)
    _match(
        surfaces.planes, points, normals, surfaces.view, surfaces.camera, poses, center_m, reach_m,
        pairs, vector, square_m2, n_matches,
    )  # fmt: skip
    matrix = np.zeros((n_views, 6, n_views, 6))
    for i in range(n_views):
        for j in range(n_views):
            matrix[i, :, i] += pairs[i, j]
            matrix[j, :, j] += pairs[i, j]
            matrix[i, :, j] -= pairs[i, j]
            matrix[j, :, i] -= pairs[i, j]
    return PairSums(matrix.reshape(6 * n_views, -1), vector.ravel(), square_m2, n_matches)


def _in_base(surfaces: ViewSurfaces, poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    rotations = poses[surfaces.view, :3, :3]
    points = np.einsum("nij,nj->ni", rotations, surfaces.points_m) + poses[surfaces.view, :3, 3]
    return points, np.einsum("nij,nj->ni", rotations, surfaces.normals)


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _match(
    planes: PlaneImage,
    points: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float64],
    view: npt.NDArray[np.int64],
    camera: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
    center: npt.NDArray[np.float64],
    reach_m: float,
    pairs: npt.NDArray[np.float64],
    vector: npt.NDArray[np.float64],
    square_m2: npt.NDArray[np.float64],
    n_matches: npt.NDArray[np.float64],
) -> None:
    """Add every point against the plane it meets in every other view."""
    step = np.empty(6)
    found = np.empty(4)
    for index in range(len(points)):
        point, own = points[index], view[index]
        for other in range(len(poses)):
            if other == own:
                continue
            _plane_at(planes[other], point, poses[other], camera, found)
            if np.isnan(found[3]) or abs(found[3]) >= reach_m:
                continue
            normal = normals[index]
            if normal[0] * found[0] + normal[1] * found[1] + normal[2] * found[2] < SMALLEST_COSINE:
                continue
            arm = point - center
            step[0] = arm[1] * found[2] - arm[2] * found[1]
            step[1] = arm[2] * found[0] - arm[0] * found[2]
            step[2] = arm[0] * found[1] - arm[1] * found[0]
            step[3:] = found[:3]
            weight = (1.0 - (found[3] / reach_m) ** 2) ** 2
            for a in range(6):
                vector[own, a] -= weight * step[a] * found[3]
                vector[other, a] += weight * step[a] * found[3]
                for b in range(6):
                    pairs[own, other, a, b] += weight * step[a] * step[b]
            square_m2[own] += found[3] ** 2
            n_matches[own] += 1.0


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _plane_at(
    planes: PlaneImage,
    point: npt.NDArray[np.float64],
    pose: npt.NDArray[np.float64],
    camera: npt.NDArray[np.float64],
    found: npt.NDArray[np.float64],
) -> None:
    """Write the normal (base frame, towards the camera) and the point's height over the plane it meets."""
    found[3] = np.nan
    dx, dy, dz = point[0] - pose[0, 3], point[1] - pose[1, 3], point[2] - pose[2, 3]
    x = pose[0, 0] * dx + pose[1, 0] * dy + pose[2, 0] * dz
    y = pose[0, 1] * dx + pose[1, 1] * dy + pose[2, 1] * dz
    z = pose[0, 2] * dx + pose[1, 2] * dy + pose[2, 2] * dz
    if z <= 0:
        return
    column = int(np.floor((camera[0] * x / z + camera[2]) / STRIDE + 0.5))
    row = int(np.floor((camera[1] * y / z + camera[3]) / STRIDE + 0.5))
    if not (0 <= row < planes.shape[0] and 0 <= column < planes.shape[1]):
        return
    a, b, c = planes[row, column, 0], planes[row, column, 1], planes[row, column, 2]
    length = np.sqrt(a * a + b * b + c * c)
    for axis in range(3):
        found[axis] = -(pose[axis, 0] * a + pose[axis, 1] * b + pose[axis, 2] * c) / length
    found[3] = (1.0 - (a * x + b * y + c * z)) / length
