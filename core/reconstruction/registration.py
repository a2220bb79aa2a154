"""The surfaces that the views show of the object, and how far they lie from one another.

A depth image shows a plane around each pixel: a smoothed distance and the direction of the surface. A plane's
inverse depth is linear over the image, and so is the noise of a camera that measures disparity, so the fit is
three sums over a window.

Each view's points are compared with the planes of the others: points to planes over all pairs of views (Chen
& Medioni 1992), all poses moved together. Views are compared with each other and not with the fused volume,
whose walls are thicker as long as the poses err.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, floor

import numba
import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray, invert_pose, transform_points
from core.scan.model import CropBox, DepthImage, Intrinsics, RgbdFrame, Scan
from core.threads import in_threads

PlaneImage = npt.NDArray[np.float32]

STRIDE = 2
HALF_WINDOW_PX = 3
LARGEST_STEP_M = 0.012
"""What differs more in depth from the middle pixel is another surface: a slope of 73 degrees at 0.7 m."""
SMALLEST_SHARE = 0.6
"""Share of the window that must lie on the surface: there is no plane beside an edge."""
LEAST_FACING = 0.1
POINTS_PER_VIEW = 900
SMALLEST_FACING = 0.35
"""Cosine between a point's normal and its ray: surfaces seen more obliquely are noisy and carry little."""
SMALLEST_COSINE = 0.8
"""Between two views' directions of one surface: keeps the two sides of a wall apart."""


@dataclass(frozen=True)
class PixelWindow:
    """Part of an image, from the first pixel (row, column) up to, but not with, the last one."""

    first: tuple[int, int]
    last: tuple[int, int]

    @classmethod
    def whole(cls, shape: tuple[int, int]) -> PixelWindow:
        """All of an image (H, W)."""
        return cls((0, 0), shape)

    @classmethod
    def of_box(cls, box: CropBox, frame: RgbdFrame, intrinsics: Intrinsics) -> PixelWindow:
        """Where a view shows a box (base frame); all of it if the box reaches behind the camera."""
        height, width = frame.depth_m.shape
        corners = np.array(list(product(*zip(box.min_m, box.max_m, strict=True))))
        x, y, z = transform_points(invert_pose(frame.T_base_camera), corners).T
        if z.min() <= 0:
            return cls.whole((height, width))
        rows = intrinsics.fy * y / z + intrinsics.cy
        columns = intrinsics.fx * x / z + intrinsics.cx
        top, bottom = np.clip([floor(rows.min()), ceil(rows.max()) + 1], 0, height).tolist()
        left, right = np.clip([floor(columns.min()), ceil(columns.max()) + 1], 0, width).tolist()
        return cls((top, left), (bottom, right))


def fit_planes(
    depth_m: DepthImage, intrinsics: Intrinsics, max_depth_m: float, window: PixelWindow | None = None
) -> PlaneImage:
    """Return planes (H / 2, W / 2, 3) of every second pixel (row, column), NaN where there is none.

    A plane (a, b, c) holds the points with `a x + b y + c z = 1` in the camera's frame, in 1/m. Outside the
    window none is looked for.
    """
    depth_m = np.ascontiguousarray(depth_m, dtype=np.float32)
    window = window or PixelWindow.whole(depth_m.shape)
    planes: PlaneImage = _fit_planes(depth_m, _pixels(intrinsics), max_depth_m, window.first, window.last)
    return planes


def _pixels(camera: Intrinsics) -> FloatArray:
    return np.array([camera.fx, camera.fy, camera.cx, camera.cy])


def facing_image(planes: PlaneImage, shape: tuple[int, int], intrinsics: Intrinsics) -> DepthImage:
    """Return (H, W): distance along the surface's normal for one of depth; 1 where no plane is known."""
    height, width = shape
    x = (np.arange(planes.shape[1]) * STRIDE - intrinsics.cx) / intrinsics.fx
    y = (np.arange(planes.shape[0]) * STRIDE - intrinsics.cy) / intrinsics.fy
    a, b, c = planes[..., 0], planes[..., 1], planes[..., 2]
    facing = (a * x + b * y[:, None] + c) / np.sqrt(a * a + b * b + c * c)
    facing = np.where(np.isnan(facing), 1.0, np.maximum(facing, LEAST_FACING)).astype(np.float32)
    return np.ascontiguousarray(facing.repeat(STRIDE, axis=0).repeat(STRIDE, axis=1)[:height, :width])


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _fit_planes(
    depth_m: DepthImage,
    camera: npt.NDArray[np.float64],
    max_depth_m: float,
    first: tuple[int, int],
    last: tuple[int, int],
) -> PlaneImage:
    height, width = depth_m.shape
    planes = np.full(((height + 1) // STRIDE, (width + 1) // STRIDE, 3), np.nan, np.float32)
    for row in range(first[0] // STRIDE * STRIDE, last[0], STRIDE):
        for column in range(first[1] // STRIDE * STRIDE, last[1], STRIDE):
            middle_m = depth_m[row, column]
            if middle_m > 0 and middle_m <= max_depth_m:
                _fit_one(depth_m, row, column, camera, planes[row // STRIDE, column // STRIDE])
    return planes


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _fit_one(
    depth_m: DepthImage,
    row: int,
    column: int,
    camera: npt.NDArray[np.float64],
    plane: npt.NDArray[np.float32],
) -> None:
    """Least squares of the inverse depth over the window, by Cramer's rule."""
    height, width = depth_m.shape
    middle_m = depth_m[row, column]
    n = su = sv = suu = suv = svv = sd = sud = svd = 0.0
    for dv in range(max(-HALF_WINDOW_PX, -row), min(HALF_WINDOW_PX, height - 1 - row) + 1):
        for du in range(max(-HALF_WINDOW_PX, -column), min(HALF_WINDOW_PX, width - 1 - column) + 1):
            z = depth_m[row + dv, column + du]
            if z > 0 and abs(z - middle_m) < LARGEST_STEP_M:
                inverse = 1.0 / z
                n += 1.0
                su += du
                sv += dv
                suu += du * du
                suv += du * dv
                svv += dv * dv
                sd += inverse
                sud += du * inverse
                svd += dv * inverse
    if n < SMALLEST_SHARE * (2 * HALF_WINDOW_PX + 1) ** 2:
        return
    cuu, cuv, cvv = suu - su * su / n, suv - su * sv / n, svv - sv * sv / n
    cud, cvd = sud - su * sd / n, svd - sv * sd / n
    determinant = cuu * cvv - cuv * cuv
    if determinant < 1e-6:
        return
    along_u = (cud * cvv - cvd * cuv) / determinant
    along_v = (cvd * cuu - cud * cuv) / determinant
    at_middle = (sd - along_u * su - along_v * sv) / n
    plane[0] = along_u * camera[0]
    plane[1] = along_v * camera[1]
    plane[2] = at_middle - along_u * (column - camera[2]) - along_v * (row - camera[3])


@dataclass(frozen=True)
class ViewSurfaces:
    """All views' surfaces of the object, each in its camera's frame.

    Attributes:
        planes: (V, h, w, 3), see `fit_planes`.
        points_m: (N, 3), points on planes, of all views.
        normals: (N, 3), unit, towards the camera.
        view: (N,), which view a point is of.
        camera: (4,), fx, fy, cx, cy in pixels.
    """

    planes: PlaneImage
    points_m: FloatArray
    normals: FloatArray
    view: IntArray
    camera: FloatArray


def view_surfaces(scan: Scan, planes: Sequence[PlaneImage], block: CropBox) -> ViewSurfaces:
    """Choose points of every view in a block (base frame) around the object."""

    def choose(view: tuple[PlaneImage, RgbdFrame]) -> tuple[FloatArray, FloatArray]:
        return _points(*view, scan.intrinsics, block)

    chosen = in_threads(choose, zip(planes, scan.frames, strict=True))
    points, normals = (np.concatenate(parts) for parts in zip(*chosen, strict=True))
    view = np.repeat(np.arange(len(chosen)), [len(of_view) for of_view, _ in chosen])
    return ViewSurfaces(np.stack(planes), points, normals, view, _pixels(scan.intrinsics))


def _points(
    planes: PlaneImage, frame: RgbdFrame, camera: Intrinsics, block: CropBox
) -> tuple[FloatArray, FloatArray]:
    """Return points and normals (N, 3) of one view, evenly thinned out, in the camera's frame."""
    rows, columns = np.nonzero(np.isfinite(planes[..., 0]))
    plane = planes[rows, columns].astype(float)
    x = (columns * STRIDE - camera.cx) / camera.fx
    y = (rows * STRIDE - camera.cy) / camera.fy
    rays = np.column_stack([x, y, np.ones_like(x)])
    inverse_depth = np.einsum("ij,ij->i", plane, rays)
    steepness = np.linalg.norm(plane, axis=1)
    facing = inverse_depth / (steepness * np.linalg.norm(rays, axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        points = rays / inverse_depth[:, None]
    in_base = transform_points(frame.T_base_camera, points)
    used = ((in_base > block.min_m) & (in_base < block.max_m)).all(axis=1) & (facing > SMALLEST_FACING)
    index = np.nonzero(used)[0]
    index = index[:: max(1, len(index) // POINTS_PER_VIEW)]
    return points[index], -plane[index] / steepness[index, None]


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
        center_m: (3,) in the base frame, about which the steps rotate.
        reach_m: the largest distance.
    """
    n_views = len(poses)
    points, normals = _in_base(surfaces, poses)
    pairs, pulls = np.zeros((n_views, n_views, 6, 6)), np.zeros((n_views, n_views, 6))
    square_m2, n_matches = np.zeros(n_views), np.zeros(n_views)

    starts = np.searchsorted(surfaces.view, np.arange(n_views + 1)).tolist()

    def match(own: int) -> None:
        of_view = slice(starts[own], starts[own + 1])
        square_m2[own], n_matches[own] = _match(
            surfaces.planes, poses, own, points[of_view], normals[of_view], surfaces.camera, center_m,
            reach_m, pairs[own], pulls[own],
        )  # fmt: skip

    # Each view writes rows of its own, so that the result does not depend on the number of threads.
    in_threads(match, range(n_views))
    pairs += np.tril(pairs, -1).swapaxes(2, 3)
    both = pairs + pairs.swapaxes(0, 1)
    matrix = -both.swapaxes(1, 2)
    each = np.arange(n_views)
    matrix[each, :, each] += both.sum(axis=1)
    vector = pulls.sum(axis=0) - pulls.sum(axis=1)
    return PairSums(matrix.reshape(6 * n_views, -1), vector.ravel(), square_m2, n_matches)


def _in_base(surfaces: ViewSurfaces, poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    rotations = poses[surfaces.view, :3, :3]
    points = np.einsum("nij,nj->ni", rotations, surfaces.points_m) + poses[surfaces.view, :3, 3]
    return points, np.einsum("nij,nj->ni", rotations, surfaces.normals)


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _match(
    planes: PlaneImage,
    poses: npt.NDArray[np.float64],
    own: int,
    points: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float64],
    camera: npt.NDArray[np.float64],
    center: npt.NDArray[np.float64],
    reach_m: float,
    pairs: npt.NDArray[np.float64],
    pulls: npt.NDArray[np.float64],
) -> tuple[float, float]:
    """Add a view's points against the planes they meet in the others; return squares' sum and number.

    One view after the other, so that its planes stay in the processor's cache.
    """
    square_m2 = n_matches = 0.0
    for other in range(len(poses)):
        if other != own:
            square, n = _match_one(
                planes[other],
                poses[other],
                points,
                normals,
                camera,
                center,
                reach_m,
                pairs[other],
                pulls[other],
            )
            square_m2 += square
            n_matches += n
    return square_m2, n_matches


@numba.njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _match_one(
    planes: PlaneImage,
    pose: npt.NDArray[np.float64],
    points: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float64],
    camera: npt.NDArray[np.float64],
    center: npt.NDArray[np.float64],
    reach_m: float,
    pairs: npt.NDArray[np.float64],
    pulls: npt.NDArray[np.float64],
) -> tuple[float, float]:
    """Add them against the planes of one other view; of `pairs` (6, 6) the lower triangle."""
    step = np.empty(6)
    square_m2 = n_matches = 0.0
    for index in range(len(points)):
        px, py, pz = points[index, 0], points[index, 1], points[index, 2]
        dx, dy, dz = px - pose[0, 3], py - pose[1, 3], pz - pose[2, 3]
        z = pose[0, 2] * dx + pose[1, 2] * dy + pose[2, 2] * dz
        if z <= 0:
            continue
        x = pose[0, 0] * dx + pose[1, 0] * dy + pose[2, 0] * dz
        y = pose[0, 1] * dx + pose[1, 1] * dy + pose[2, 1] * dz
        column = int(np.floor((camera[0] * x / z + camera[2]) / STRIDE + 0.5))
        row = int(np.floor((camera[1] * y / z + camera[3]) / STRIDE + 0.5))
        if not (0 <= row < planes.shape[0] and 0 <= column < planes.shape[1]):
            continue
        a, b, c = planes[row, column, 0], planes[row, column, 1], planes[row, column, 2]
        length = np.sqrt(a * a + b * b + c * c)
        height_m = (1.0 - (a * x + b * y + c * z)) / length
        if np.isnan(height_m) or abs(height_m) >= reach_m:
            continue
        # The plane's normal in the base frame, towards the camera.
        nx = -(pose[0, 0] * a + pose[0, 1] * b + pose[0, 2] * c) / length
        ny = -(pose[1, 0] * a + pose[1, 1] * b + pose[1, 2] * c) / length
        nz = -(pose[2, 0] * a + pose[2, 1] * b + pose[2, 2] * c) / length
        if normals[index, 0] * nx + normals[index, 1] * ny + normals[index, 2] * nz < SMALLEST_COSINE:
            continue
        arm_x, arm_y, arm_z = px - center[0], py - center[1], pz - center[2]
        step[0], step[3] = arm_y * nz - arm_z * ny, nx
        step[1], step[4] = arm_z * nx - arm_x * nz, ny
        step[2], step[5] = arm_x * ny - arm_y * nx, nz
        weight = (1.0 - (height_m / reach_m) ** 2) ** 2
        for k in range(6):
            pulls[k] += weight * step[k] * height_m
            for m in range(k + 1):
                pairs[k, m] += weight * step[k] * step[m]
        square_m2 += height_m**2
        n_matches += 1.0
    return square_m2, n_matches
