"""Views fused as they are, neither weighed nor their poses refined: quickly, to look at."""

from __future__ import annotations

from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan

COARSE_VOXEL_M = 0.004
FRONT_VOXELS, BEHIND_VOXELS = 4.0, 2.5
FARTHEST_M = 6.0

_fused: list[tuple[Scan, CropBox, TsdfVolume]] = []
"""What `coarse_volume` fused last."""


def empty_coarse_volume(box: CropBox) -> TsdfVolume:
    """A volume over the crop box, as coarse as coverage and a live picture need."""
    front_m, behind_m = FRONT_VOXELS * COARSE_VOXEL_M, BEHIND_VOXELS * COARSE_VOXEL_M
    return TsdfVolume(box.min_m, box.max_m, COARSE_VOXEL_M, front_m, behind_m)


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
