"""What the views could not see: solid above the support, and nothing below it.

The inside of a wall and of a floor is seen by no view. Left free, the fused surface is a crust as thick as
the truncation; taken as solid, a wall is as thick as the views from its two sides say and the object stands
flat on its support.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.ndimage import binary_fill_holes

from core.geometry import BoolArray, FloatArray
from core.reconstruction.planes import Plane
from core.reconstruction.segmentation import Part
from core.reconstruction.tsdf import DistanceGrid, TsdfVolume

SMALLEST_DISTANCE = np.float32(1e-4)
"""Marching cubes makes faces without area where a distance is exactly zero."""


FLOOR_VOXELS = 1.5
"""Thinner than a voxel, a floor may lie between two of them and be lost."""


def fill_unseen(volume: TsdfVolume, part: Part) -> DistanceGrid:
    """Distances (x, y, z) of the part with -1 in every voxel that only views from behind a surface know of.

    A voxel that lies in no view, or in none with a depth, stays free: it hides behind nothing.
    """
    distance = volume.distance[part.slices].copy()
    distance[(volume.weight[part.slices] == 0) & volume.hidden[part.slices]] = -1.0
    return distance


def cut_at_height(distance: DistanceGrid, volume: TsdfVolume, part: Part, height_m: float) -> DistanceGrid:
    """Remove what lies below a horizontal plane in the base frame."""
    _, _, z = _centers(volume, part)
    return _above(distance, z - height_m, volume.truncation_m)


def keep_floor(
    distance: DistanceGrid, volume: TsdfVolume, part: Part, support_m: float, error_m: float
) -> DistanceGrid:
    """Give what stands on the support a floor of `FLOOR_VOXELS` where it was seen to have one at all.

    The inside of a low floor lies so near the support that noise puts half of it below: cut there, it is
    full of holes. Where a column is solid anywhere from a little below the support to a voxel above it,
    something kept the views from looking through to the table.

    Args:
        distance: (x, y, z) of the part, before it is cut at the support; below that it is filled, too.
        volume: it is taken from.
        part: it covers; reaches a little below the support.
        support_m: height of the support.
        error_m: how far a surface may err.
    """
    _, _, z = _centers(volume, part)
    near = (z > support_m - error_m - volume.voxel_m) & (z < support_m + volume.voxel_m)
    stands = np.any((distance < 0) & near, axis=2, keepdims=True)
    thickness_m = FLOOR_VOXELS * volume.voxel_m
    floor = np.abs(z - support_m - thickness_m / 2) - thickness_m / 2
    kept = np.where(stands, np.minimum(distance, floor / volume.truncation_m), distance)
    return kept.astype(np.float32)


def cut_at_table(
    distance: DistanceGrid, volume: TsdfVolume, part: Part, table: Plane, margin_m: float
) -> DistanceGrid:
    """Remove what lies below the table, and around the object also what lies `margin_m` above it.

    Under and inside the object nothing is removed above the table, so that a low floor stays (the footnote of
    Sec. IV-A tells of a bag that loses it).
    """
    x, y, z = _centers(volume, part)
    height_m = z - table.height_m(x, y)
    is_object = (distance < 0) & (height_m > margin_m)
    footprint: BoolArray = binary_fill_holes(np.any(is_object, axis=2).astype(np.bool_))
    around = np.where(footprint[:, :, None], height_m, height_m - margin_m)
    return _above(distance, around, volume.truncation_m)


def _above(distance: DistanceGrid, height_m: npt.ArrayLike, truncation_m: float) -> DistanceGrid:
    below = np.clip(-np.asarray(height_m) / truncation_m, -1.0, 1.0).astype(np.float32)
    cut = np.maximum(distance, below)
    cut[np.abs(cut) < SMALLEST_DISTANCE] = SMALLEST_DISTANCE
    return cut


def _centers(volume: TsdfVolume, part: Part) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates of the part's voxel centres, shaped to broadcast: (x, 1, 1), (1, y, 1), (1, 1, z)."""
    axes = [
        volume.origin_m[axis] + volume.voxel_m * np.arange(part.low[axis], part.high[axis])
        for axis in range(3)
    ]
    x, y, z = np.ix_(*axes)
    return x, y, z
