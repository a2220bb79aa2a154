"""The box of what stands on the platform, from a few views of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import label

from core.geometry import BoolArray, FloatArray
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox

ABOVE_PLATFORM_M = 0.01
"""Lower things are the platform, where it is seen at all, and noise."""
FEWEST_VOXELS = 100
"""Fewer surface voxels that touch each other are noise: about 10 square centimetres at 4 mm."""
TOUCHING = np.ones((3, 3, 3), dtype=np.bool_)


@dataclass(frozen=True)
class ObjectBox:
    """Where the object is, in the base frame.

    Attributes:
        min_m: (3,) lower corner, on the platform.
        max_m: (3,) upper corner.
    """

    min_m: FloatArray
    max_m: FloatArray

    @property
    def size_m(self) -> FloatArray:
        """(3,) its edges."""
        return self.max_m - self.min_m

    def is_within(self, box: CropBox) -> bool:
        """Whether it does not leave a box sideways or upwards."""
        return bool((self.min_m[:2] >= box.min_m[:2]).all() and (self.max_m <= box.max_m).all())


def find_object_box(volume: TsdfVolume, platform_height_m: float, space: CropBox) -> ObjectBox | None:
    """Return the box of the surfaces above the platform; none if there are none.

    Args:
        volume: the views, fused; larger than `space`, so that it shows what does not fit.
        platform_height_m: of the platform's top.
        space: where an object may stand; what lies beyond counts if it is connected with something in it.
    """
    first = np.ceil((platform_height_m + ABOVE_PLATFORM_M - volume.origin_m[2]) / volume.voxel_m)
    surface = volume.surface_voxels()
    surface = surface[surface[:, 2] >= first]
    grid = np.zeros(volume.weight.shape, dtype=np.bool_)
    grid[tuple(surface.T)] = True
    part_of = label(grid, structure=TOUCHING)[0][tuple(surface.T)]
    centers_m = volume.centers_m(surface)
    size = np.bincount(part_of)
    inside = np.bincount(part_of, weights=_is_inside(centers_m, space), minlength=len(size))
    of_object = centers_m[((size >= FEWEST_VOXELS) & (inside > 0))[part_of]]
    if len(of_object) == 0:
        return None
    low_m, high_m = of_object.min(axis=0) - volume.voxel_m / 2, of_object.max(axis=0) + volume.voxel_m / 2
    return ObjectBox(np.array([*low_m[:2], platform_height_m]), high_m)


def _is_inside(points_m: FloatArray, box: CropBox) -> BoolArray:
    """Which points (N, 3) lie in a box."""
    return np.asarray(((points_m >= box.min_m) & (points_m <= box.max_m)).all(axis=1))
