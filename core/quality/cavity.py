"""The unseen inside of an opening, found in the fused volume without any model of the object."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label

from core.geometry import BoolArray
from core.quality.measures import HiddenCavity
from core.reconstruction.tsdf import TsdfVolume
from core.reconstruction.unseen import find_unseen_inside

RIM_LAYERS = 4


def find_hidden_cavity(volume: TsdfVolume, platform_height_m: float) -> HiddenCavity:
    """Find where the views ended inside openings; 50 ms at 4 mm.

    Args:
        volume: fused from the views; its wall must be closed in each layer, or the layer counts as open.
        platform_height_m: of the support, in the base frame; what lies below it is not looked at.
    """
    unseen = find_unseen_inside(volume, platform_height_m)
    if not unseen.frontier.any():
        return HiddenCavity(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    depth, width = _depth_and_width(unseen.frontier, unseen.enclosed)
    up = np.array([0, 0, unseen.first_layer])
    return HiddenCavity(
        frontier_m=volume.centers_m(np.argwhere(unseen.frontier) + up),
        region=np.argwhere(unseen.region) + up,
        area_m2=float(unseen.frontier.sum() * volume.voxel_m**2),
        volume_ml=float(unseen.region.sum() * volume.voxel_m**3 * 1e6),
        depth_m=depth * volume.voxel_m,
        width_m=width * volume.voxel_m,
    )


def _depth_and_width(frontier: BoolArray, enclosed: BoolArray) -> tuple[float, float]:
    """Depth of the frontier below the rim and diameter of the opening just below the rim, in voxels."""
    openings, _ = label(enclosed)
    inside = openings == np.bincount(openings[frontier]).argmax()
    areas = inside.sum(axis=(0, 1))
    rim = int(np.nonzero(areas)[0][-1])
    depth = rim + 1 - np.median(np.nonzero(frontier & inside)[2])
    return float(depth), float(np.sqrt(4 / np.pi * np.median(areas[max(rim - RIM_LAYERS, 0) : rim])))
