"""The assessment of a finished scan: all measures, then the verdict."""

from __future__ import annotations

import numpy as np

from core.quality.cavity import find_hidden_cavity
from core.quality.coverage import count_views, unseen_share
from core.quality.measures import ScanQuality
from core.quality.reasons import judge
from core.quality.view_quality import ModelResiduals, ViewQuality, check_view
from core.reconstruction.result import Reconstruction
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, Scan


def assess(
    scan: Scan, volume: TsdfVolume, reconstruction: Reconstruction, *, table_height_m: float | None = None
) -> ScanQuality:
    """Judge a scan by itself and by what was reconstructed from it; 1 s for 24 views.

    Args:
        scan: with the poses as recorded; where the reconstruction refined them, its own are used to compare
            depth and model, the recorded ones for the table.
        volume: all views fused over the crop box, coarse (coarse_volume) or finer.
        reconstruction: made from this scan.
        table_height_m: where the cell has its table; without it, where most of the views see it.
    """
    mesh, refinement = reconstruction.mesh, reconstruction.refinement
    fused = scan if refinement is None else refinement.applied_to(scan)
    residuals = ModelResiduals(mesh, reconstruction.platform_height_m)
    pairs = zip(_views(scan, _box_of(volume), table_height_m), fused.frames, strict=True)
    views = tuple(residuals.add_to(view, frame, scan.intrinsics) for view, frame in pairs)
    cavity = find_hidden_cavity(volume, reconstruction.platform_height_m)
    n_views = count_views(mesh, fused)
    share = unseen_share(mesh, n_views)
    return ScanQuality(views, cavity, n_views, share, *judge(views, cavity, share))


def _views(scan: Scan, box: CropBox, table_height_m: float | None) -> tuple[ViewQuality, ...]:
    befores = (None, *scan.frames[:-1])
    pairs = list(zip(scan.frames, befores, strict=True))
    views = tuple(
        check_view(frame, scan.intrinsics, box, before=before, table_height_m=table_height_m)
        for frame, before in pairs
    )
    heights = [view.table_height_m for view in views if view.table_height_m is not None]
    if table_height_m is not None or not heights:
        return views
    middle_m = float(np.median(heights))
    return tuple(view.against_table(middle_m) for view in views)


def _box_of(volume: TsdfVolume) -> CropBox:
    low = volume.origin_m
    high = low + volume.voxel_m * np.array(volume.weight.shape)
    return CropBox((low[0], low[1], low[2]), (high[0], high[1], high[2]))
