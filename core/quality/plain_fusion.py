"""Views fused as they are, neither weighed nor their poses refined: quickly, to look at and to plan with."""

from __future__ import annotations

import numpy as np

from core.quality.object_box import find_object_box
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan, crop_box

COARSE_VOXEL_M = 0.004
CLOSE_VOXEL_M = 0.002
CLOSE_MARGIN_M = 0.02
"""Around the object's box; a ring of wall must close within the volume."""
CLOSE_M3 = 0.005
"""A larger box has a mouth that is wide enough for coarse voxels, and would take seconds in fine ones."""
FRONT_VOXELS, BEHIND_VOXELS = 4.0, 2.5
FARTHEST_M = 6.0

_fused: list[tuple[Scan, CropBox, TsdfVolume]] = []
"""What `coarse_volume` fused last."""


def empty_coarse_volume(box: CropBox) -> TsdfVolume:
    """A volume over the crop box, as coarse as coverage and a live picture need."""
    return _empty_volume(box, COARSE_VOXEL_M)


def fuse_plainly(volume: TsdfVolume, frame: RgbdFrame, intrinsics: Intrinsics) -> None:
    """Fuse one view as it is, neither weighed nor its pose refined; 12 ms into a coarse volume."""
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
        fuse_plainly(volume, frame, scan.intrinsics)
    _fused[:] = [(scan, box, volume)]
    return volume


def close_volume(scan: Scan, coarse: TsdfVolume, platform_height_m: float, box: CropBox) -> TsdfVolume | None:
    """Fuse all views in fine voxels, around the object alone; 0.3 s.

    What a narrow mouth shows is told from its true width alone: coarse voxels take half of one of 36 mm.

    Args:
        scan: everything that was taken.
        coarse: all of it, fused.
        platform_height_m: of the support, in the base frame.
        box: within which the object stands; its lower end is the volume's.

    Returns:
        The volume; none if there is no object, or one so large that coarse voxels do.
    """
    found = find_object_box(coarse, platform_height_m, box)
    if found is None or found.size_m.prod() > CLOSE_M3:
        return None
    low_m = np.maximum(found.min_m - CLOSE_MARGIN_M, box.min_m)
    high_m = np.minimum(found.max_m + CLOSE_MARGIN_M, box.max_m)
    volume = _empty_volume(crop_box([*low_m[:2], box.min_m[2]], high_m), CLOSE_VOXEL_M)
    for frame in scan.frames:
        fuse_plainly(volume, frame, scan.intrinsics)
    return volume


def _empty_volume(box: CropBox, voxel_m: float) -> TsdfVolume:
    return TsdfVolume(box.min_m, box.max_m, voxel_m, FRONT_VOXELS * voxel_m, BEHIND_VOXELS * voxel_m)
