"""Fusing all views of a scan into a volume, coarsely where the object is looked for and finely around it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.progress import Reporter
from core.reconstruction.depth_planes import PlaneImage, facing_image, fit_planes
from core.reconstruction.segmentation import Part
from core.reconstruction.truncation import Truncation
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, Scan

STAGE = "reconstruction"


class Steps:
    """Counts the views of all fusions that a reconstruction needs."""

    def __init__(self, reporter: Reporter, total: int) -> None:
        self._reporter = reporter
        self._total = total
        self._done = 0

    def next(self) -> None:
        """Count one view.

        Raises:
            Cancelled: the user asked to stop.
        """
        self._done += 1
        self._reporter.progress(STAGE, self._done, self._total)
        self._reporter.raise_if_cancelled()


def fit_all_planes(scan: Scan, max_depth_m: float, reporter: Reporter) -> tuple[PlaneImage, ...]:
    """Fit planes in all views.

    Raises:
        Cancelled: the user asked to stop.
    """
    planes = []
    for frame in scan.frames:
        reporter.raise_if_cancelled()
        planes.append(fit_planes(frame.depth_m, scan.intrinsics, max_depth_m))
    return tuple(planes)


def fuse(
    scan: Scan,
    box: CropBox,
    voxel_m: float,
    truncation: Truncation,
    max_depth_m: float,
    steps: Steps,
    planes: Sequence[PlaneImage] | None = None,
) -> TsdfVolume:
    """Fuse all views in a box; with `planes` distances are taken along the surfaces' normals.

    Raises:
        StageError: the box holds too many voxels.
        Cancelled: the user asked to stop.
    """
    volume = TsdfVolume(
        box.min_m, box.max_m, voxel_m, truncation.front_m, truncation.behind_m, truncation.falloff_m
    )
    for index, frame in enumerate(scan.frames):
        facing = None
        if planes is not None:
            facing = facing_image(planes[index], frame.depth_m.shape, scan.intrinsics)
        volume.integrate(frame, scan.intrinsics, max_depth_m, facing)
        steps.next()
    return volume


def block_of(volume: TsdfVolume, part: Part) -> CropBox:
    """Return the part's block as a box in the base frame."""
    low, high = volume.centers_m(part.low).tolist(), volume.centers_m(part.high - 1).tolist()
    return CropBox((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def whole(volume: TsdfVolume) -> Part:
    """Return all of a volume as the object's part."""
    return Part(np.zeros(3, dtype=np.int64), np.array(volume.distance.shape), volume.surface_voxels())
