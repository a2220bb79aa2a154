"""The unseen inside of an opening, found in the fused volume without any model of the object.

Where known free space ends at voxels that no view saw, the views could not look further. Around the object
that is an ordinary shadow; within a closed ring of wall it is the inside of something that may hold candies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, generate_binary_structure, label

from core.geometry import BoolArray
from core.quality.measures import HiddenCavity
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan

COARSE_VOXEL_M = 0.004
FRONT_VOXELS, BEHIND_VOXELS = 4.0, 2.5
FARTHEST_M = 6.0
FREE_SHARE = 0.5
"""Share of the truncation in front of the surface from which on a voxel is surely free."""
SMALLEST_PATCH_M2 = 1e-4
"""Smaller frontiers are gaps that noise leaves; 10 mm by 10 mm."""
RIM_LAYERS = 4
ALL_NEIGHBOURS = generate_binary_structure(3, 3)
IN_LAYER = generate_binary_structure(3, 1) & np.array([False, True, False])
"""The four neighbours within a horizontal layer; the last axis is z."""

_fused: list[tuple[Scan, CropBox, TsdfVolume]] = []
"""What `coarse_volume` fused last."""


@dataclass(frozen=True)
class _Block:
    """The part of a volume above the platform, as masks (X, Y, Z); `first_layer` is its lowest layer."""

    unseen: BoolArray
    free: BoolArray
    solid: BoolArray
    first_layer: int


def find_hidden_cavity(volume: TsdfVolume, platform_height_m: float) -> HiddenCavity:
    """Find where the views ended inside openings; 50 ms at 4 mm.

    Args:
        volume: fused from the views; its wall must be closed in each layer, or the layer counts as open.
        platform_height_m: of the support, in the base frame; what lies below it is not looked at.
    """
    block = _above_platform(volume, platform_height_m)
    enclosed = _enclosed_in_layer(block.solid)
    frontier = enclosed & block.unseen & binary_dilation(block.free & enclosed)
    frontier = _large_patches(frontier, SMALLEST_PATCH_M2 / volume.voxel_m**2)
    if not frontier.any():
        return HiddenCavity(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    region = _connected_to(frontier, enclosed & block.unseen)
    depth, width = _depth_and_width(frontier, enclosed)
    up = np.array([0, 0, block.first_layer])
    return HiddenCavity(
        frontier_m=volume.centers_m(np.argwhere(frontier) + up),
        region=np.argwhere(region) + up,
        area_m2=float(frontier.sum() * volume.voxel_m**2),
        volume_ml=float(region.sum() * volume.voxel_m**3 * 1e6),
        depth_m=depth * volume.voxel_m,
        width_m=width * volume.voxel_m,
    )


def empty_coarse_volume(box: CropBox) -> TsdfVolume:
    """A volume over the crop box, as coarse as coverage and a live picture need."""
    return TsdfVolume(
        box.min_m, box.max_m, COARSE_VOXEL_M, FRONT_VOXELS * COARSE_VOXEL_M, BEHIND_VOXELS * COARSE_VOXEL_M
    )


def fuse_coarsely(volume: TsdfVolume, frame: RgbdFrame, intrinsics: Intrinsics) -> None:
    """Fuse one view into a coarse volume; 12 ms."""
    volume.integrate(frame, intrinsics, FARTHEST_M)


def coarse_volume(scan: Scan, box: CropBox) -> TsdfVolume:
    """Fuse all views coarsely, the same scan (see `stored_scan`) once per process; 0.3 s.

    The volume is shared: do not fuse anything else into it.
    """
    for known_scan, known_box, volume in _fused:
        if known_scan is scan and known_box == box:
            return volume
    volume = empty_coarse_volume(box)
    for frame in scan.frames:
        fuse_coarsely(volume, frame, scan.intrinsics)
    _fused[:] = [(scan, box, volume)]
    return volume


def _above_platform(volume: TsdfVolume, platform_height_m: float) -> _Block:
    first = (platform_height_m - volume.origin_m[2]) / volume.voxel_m
    first_layer = int(np.clip(np.ceil(first + 1), 0, volume.weight.shape[2] - 1))
    seen = volume.weight[:, :, first_layer:] > 0
    distance = volume.distance[:, :, first_layer:]
    return _Block(~seen, seen & (distance > FREE_SHARE), seen & (distance < 0), first_layer)


def _enclosed_in_layer(solid: BoolArray) -> BoolArray:
    """What a flood from the border of each horizontal layer does not reach, around the solid."""
    groups, _ = label(~solid, structure=IN_LAYER)
    border = [groups[0], groups[-1], groups[:, 0], groups[:, -1]]
    outside = np.unique(np.concatenate([edge.ravel() for edge in border]))
    enclosed: BoolArray = ~np.isin(groups, outside) & ~solid
    return enclosed


def _large_patches(mask: BoolArray, fewest_voxels: float) -> BoolArray:
    patches, _ = label(mask, structure=ALL_NEIGHBOURS)
    is_large = np.bincount(patches.ravel()) >= fewest_voxels
    is_large[0] = False
    large: BoolArray = is_large[patches]
    return large


def _connected_to(seeds: BoolArray, mask: BoolArray) -> BoolArray:
    """The groups of `mask` that hold a seed."""
    groups, _ = label(mask)
    held: BoolArray = mask & np.isin(groups, np.unique(groups[seeds]))
    return held


def _depth_and_width(frontier: BoolArray, enclosed: BoolArray) -> tuple[float, float]:
    """Depth of the frontier below the rim and diameter of the opening just below the rim, in voxels."""
    openings, _ = label(enclosed)
    inside = openings == np.bincount(openings[frontier]).argmax()
    areas = inside.sum(axis=(0, 1))
    rim = int(np.nonzero(areas)[0][-1])
    depth = rim + 1 - np.median(np.nonzero(frontier & inside)[2])
    return float(depth), float(np.sqrt(4 / np.pi * np.median(areas[max(rim - RIM_LAYERS, 0) : rim])))
