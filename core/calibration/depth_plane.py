"""How true a camera's depth is: the flat surface that fills the middle of its image, against a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.scan.model import DepthImage, Intrinsics

SMALLEST_SHARE = 0.5
"""Of the middle of the image: less of it in one plane is no flat surface."""
MOST_RMS_SHARE = 0.01
"""Of the distance: at the usual 0.6 m that is three voxels of a scan."""
_MIDDLE = 0.6
"""Of width and height."""
_MOST_POINTS = 6_000
_N_TRIES = 200
_BAND_SHARE = 0.04
"""Of the distance; beyond it no point belongs to the plane."""
_N_REFITS = 4
_SIGMAS = 3.5


@dataclass(frozen=True)
class DepthPlane:
    """The plane in the middle of a depth image.

    Attributes:
        rms_m: of the distances of its points from it; outliers beyond 3.5 standard deviations are left out.
        distance_m: of its points along the optical axis, their median.
        share: of what was measured in the middle of the image that belongs to it.
        tilt_rad: of its normal against the optical axis.
    """

    rms_m: float
    distance_m: float
    share: float
    tilt_rad: float

    @property
    def is_flat(self) -> bool:
        """Whether there is a flat surface to measure by."""
        return self.share >= SMALLEST_SHARE

    @property
    def is_true(self) -> bool:
        """Whether the depth is good enough to scan with."""
        return self.rms_m <= MOST_RMS_SHARE * self.distance_m


def find_plane(depth_m: DepthImage, intrinsics: Intrinsics) -> DepthPlane | None:
    """Fit a plane to the middle of a depth image (H, W); none if too little was measured there.

    Most of the points decide where it is (random triples, always the same ones), and those near it, fitted by
    least squares, how true it is.
    """
    points = _middle_points_m(depth_m, intrinsics)
    if len(points) < 100:
        return None
    distance_m = float(np.median(points[:, 2]))
    band_m = _BAND_SHARE * distance_m
    near = _largest_plane(points, band_m)
    for _ in range(_N_REFITS):
        normal, offset_m = _fitted(points[near])
        off_m = points @ normal - offset_m
        # half of the absolute deviations of a normal distribution lie within 0.6745 standard deviations
        sigma_m = float(np.median(np.abs(off_m[near]))) / 0.6745
        near = np.abs(off_m) <= np.clip(_SIGMAS * sigma_m, 1e-6, band_m)
    rms_m = float(np.sqrt(np.mean(off_m[near] ** 2)))
    tilt_rad = float(np.arccos(min(abs(normal[2]), 1.0)))
    return DepthPlane(rms_m, float(np.median(points[near, 2])), float(near.mean()), tilt_rad)


def _middle_points_m(depth_m: DepthImage, intrinsics: Intrinsics) -> FloatArray:
    """Some points (N, 3) in the camera's frame."""
    height, width = depth_m.shape
    border = (1 - _MIDDLE) / 2
    rows, columns = np.mgrid[
        int(border * height) : int((1 - border) * height), int(border * width) : int((1 - border) * width)
    ]
    z = depth_m[rows, columns].astype(float).ravel()
    x = (columns.ravel() - intrinsics.cx) / intrinsics.fx * z
    y = (rows.ravel() - intrinsics.cy) / intrinsics.fy * z
    points = np.column_stack([x, y, z])[z > 0]
    some: FloatArray = points[:: max(len(points) // _MOST_POINTS, 1)]
    return some


def _largest_plane(points_m: FloatArray, band_m: float) -> BoolArray:
    """Which points (N,) lie in the plane through three of them that most others lie in."""
    random = np.random.default_rng(0)
    best = np.zeros(len(points_m), dtype=bool)
    for _ in range(_N_TRIES):
        a, b, c = points_m[random.choice(len(points_m), 3, replace=False)]
        normal = np.cross(b - a, c - a)
        length = float(np.linalg.norm(normal))
        if length < 1e-9:
            continue
        near: BoolArray = np.abs((points_m - a) @ normal) <= band_m * length
        if near.sum() > best.sum():
            best = near
    return best


def _fitted(points_m: FloatArray) -> tuple[FloatArray, float]:
    """Unit normal (3,) and distance from the origin of the plane through points (N, 3)."""
    middle = points_m.mean(axis=0)
    normal = np.linalg.svd(points_m - middle, full_matrices=False)[2][2]
    return normal, float(normal @ middle)
