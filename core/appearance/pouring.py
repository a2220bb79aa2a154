"""Where to pour by looks: the centroid of what contains, projected into space (Sec. V-B).

After Do, Nguyen and Reid 2018, as the paper uses it. The direction cannot be told by looks and is fixed.
"""

from __future__ import annotations

import numpy as np

from core.appearance.looking import CONTAINS, ViewLook
from core.geometry import FloatArray, transform_points
from core.scan.model import Intrinsics, RgbdFrame

OFFSET_M = 0.12
"""Delta h of the first row, which the paper does not state: the pivot's height above the point poured at. One
centimetre over the rim of the deepest cup or bowl among the development objects (105 mm)."""
THETA_RAD = 0.0
"""theta_pour: the same as that of "Imagination w/ fixed theta"."""


def contain_point(look: ViewLook, frame: RgbdFrame, intrinsics: Intrinsics) -> FloatArray | None:
    """Project the centroid of the pixels that contain; none if none does, or nothing was measured.

    The depth is that of the pixel there, or of the nearest one that has any.
    """
    rows, columns = np.nonzero(look.contain_map(frame.depth_m.shape) > CONTAINS)
    if not len(rows):
        return None
    v, u = float(rows.mean()), float(columns.mean())
    depth_m = _depth_near(frame, v, u)
    if depth_m is None:
        return None
    in_camera = np.array([(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1.0])
    return transform_points(frame.T_base_camera, depth_m * in_camera)


def at_offset(point_m: FloatArray) -> FloatArray:
    """Return r_pivot (3,) a fixed height above the point poured at: the row "AffordanceNet"."""
    pivot_m: FloatArray = point_m + np.array([0.0, 0.0, OFFSET_M])
    return pivot_m


def above_box(point_m: FloatArray, aabb_m: FloatArray, clearance_m: float) -> FloatArray:
    """Return r_pivot (3,) above the scanned object's AABB (2, 3): the row "w/ 3D Scanning"."""
    return np.array([*point_m[:2], aabb_m[1, 2] + clearance_m])


def _depth_near(frame: RgbdFrame, v: float, u: float) -> float | None:
    rows, columns = np.nonzero(frame.depth_m > 0)
    if not len(rows):
        return None
    nearest = np.hypot(rows - v, columns - u).argmin()
    return float(frame.depth_m[rows[nearest], columns[nearest]])
