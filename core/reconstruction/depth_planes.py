"""The plane that a depth image shows around each pixel: a smoothed distance and the direction of the surface.

A plane's inverse depth is linear over the image, and so is the noise of a camera that measures disparity, so
the fit is three sums over a window.
"""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from core.scan.model import DepthImage, Intrinsics

PlaneImage = npt.NDArray[np.float32]

STRIDE = 2
HALF_WINDOW_PX = 3
LARGEST_STEP_M = 0.012
"""What differs more in depth from the middle pixel is another surface: a slope of 73 degrees at 0.7 m."""
SMALLEST_SHARE = 0.6
"""Share of the window that must lie on the surface: beside an edge nothing is said."""

LEAST_FACING = 0.1


def fit_planes(depth_m: DepthImage, intrinsics: Intrinsics, max_depth_m: float) -> PlaneImage:
    """Return planes (H / 2, W / 2, 3) of every second pixel (row, column), NaN where there is none.

    A plane (a, b, c) holds the points with `a x + b y + c z = 1` in the camera's frame, in 1/m.
    """
    camera = np.array([intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy])
    planes: PlaneImage = _fit_planes(np.ascontiguousarray(depth_m, dtype=np.float32), camera, max_depth_m)
    return planes


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
def _fit_planes(depth_m: DepthImage, camera: npt.NDArray[np.float64], max_depth_m: float) -> PlaneImage:
    height, width = depth_m.shape
    planes = np.full(((height + 1) // STRIDE, (width + 1) // STRIDE, 3), np.nan, np.float32)
    for row in range(0, height, STRIDE):
        for column in range(0, width, STRIDE):
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
