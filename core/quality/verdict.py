"""The assessment of a finished scan: all measures, then the verdict, its rules and their sentences.

The limits come from simulated scans with growing pose errors (docs/decisions/0007-scan-quality.md) and lie
where the reconstruction is still right, so that the warning comes before the failure.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray, invert_pose, transform_points
from core.mesh import TriangleMesh
from core.quality.cavity import find_hidden_cavity
from core.quality.measures import HiddenCavity, ScanQuality, residual_m, table_sd_m
from core.quality.verdict_words import AGAIN, GOOD, USABLE, VERDICTS
from core.quality.view_quality import ModelResiduals, ViewQuality, check_view
from core.reconstruction.result import Reconstruction
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, RgbdFrame, Scan

TABLE_SD_USABLE_M, TABLE_SD_AGAIN_M = 0.0025, 0.006
"""With refined poses the surface errs by 1 mm from 3.5 mm on, and walls get lost from 8.5 mm on."""
RESIDUAL_USABLE_M, RESIDUAL_AGAIN_M = 0.001, 0.0014
"""0.6 mm with refined poses; capacity begins to be 10 % off at 1.2 mm; above 1.4 mm most are."""
UNSEEN_USABLE = 0.10
"""More makes a scan usable, not worse: a belly below a narrow neck is seen by no view at all."""
HIDDEN_AREA_USABLE_M2 = 2e-4
SHIFTED_TABLE_M = 0.003
MOST_LISTED = 3
"""Problems of single views that are listed one by one."""
FEWEST_VIEWS = 12
CALIBRATE = "calibrate the camera's mounting (hand-eye calibration)"
TOLERANCE_M = 0.008
"""How far a measured depth may be off a vertex that it shows: noise, pose error and the fusion's rounding. A
wall's other side is nearer than that, but it faces away."""
DOWNWARD = -0.2
"""Upward part of the normal below which a face looks down: all views come from above, none can see it."""


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


@dataclass(frozen=True)
class Reason:
    """Why the scan is no better than `verdict`."""

    verdict: str
    sentence: str


def judge(
    views: tuple[ViewQuality, ...], cavity: HiddenCavity, unseen_share: float
) -> tuple[str, tuple[str, ...]]:
    """Return the verdict and its reasons, the worst first."""
    found = [*_of_views(views), *_of_poses(views), *_of_coverage(cavity, unseen_share)]
    if not found:
        return GOOD, ("good: the views agree, and they saw the object and the inside of its openings.",)
    found.sort(key=lambda reason: VERDICTS.index(reason.verdict), reverse=True)
    return found[0].verdict, tuple(f"{reason.verdict}: {reason.sentence}" for reason in found)


def _of_views(views: tuple[ViewQuality, ...]) -> Iterator[Reason]:
    n_useful = sum(not view.is_useless for view in views)
    if n_useful < FEWEST_VIEWS:
        yield Reason(
            AGAIN,
            f"only {n_useful} of {len(views)} views are usable and {FEWEST_VIEWS} are needed; "
            "take the others again.",
        )
    problems = [problem for view in views for problem in view.problems]
    yield from (Reason(USABLE, problem) for problem in problems[:MOST_LISTED])
    if len(problems) > MOST_LISTED:
        yield Reason(
            USABLE, f"{len(problems) - MOST_LISTED} more problems of single views are listed with the views."
        )


def _of_poses(views: tuple[ViewQuality, ...]) -> Iterator[Reason]:
    sd_m, rms_m = table_sd_m(views), residual_m(views)
    if sd_m is not None and sd_m > TABLE_SD_USABLE_M:
        yield Reason(
            AGAIN if sd_m > TABLE_SD_AGAIN_M else USABLE,
            f"the views disagree about the table by {_mm(sd_m)} (above {_mm(TABLE_SD_USABLE_M)} the model is "
            f"misplaced, above {_mm(TABLE_SD_AGAIN_M)} walls are lost): {CALIBRATE}.",
        )
    offsets_m = [view.table_offset_m for view in views if view.table_offset_m is not None]
    shift_m = float(np.median(offsets_m)) if offsets_m else 0.0
    if abs(shift_m) > SHIFTED_TABLE_M:
        side = "above" if shift_m > 0 else "below"
        yield Reason(
            USABLE, f"the views see the table {_mm(abs(shift_m))} {side} its known height: {CALIBRATE}."
        )
    if rms_m is not None and rms_m > RESIDUAL_USABLE_M:
        yield Reason(
            AGAIN if rms_m > RESIDUAL_AGAIN_M else USABLE,
            f"the depth images are {_mm(rms_m)} off the model (above {_mm(RESIDUAL_AGAIN_M)} its walls are "
            f"wrong): {CALIBRATE}, make sure that the object does not move, and reconstruct with the default "
            "settings.",
        )


def _of_coverage(cavity: HiddenCavity, unseen_share: float) -> Iterator[Reason]:
    if cavity.area_m2 > HIDDEN_AREA_USABLE_M2:
        yield Reason(
            USABLE,
            f"the inside of an opening {cavity.width_m * 1000:.0f} mm wide was not seen below "
            f"{cavity.depth_m * 1000:.0f} mm, where it counts as solid; look again from further views.",
        )
    if unseen_share > UNSEEN_USABLE:
        yield Reason(
            USABLE,
            f"no view saw {unseen_share:.0%} of the surface; what lies behind it counts as solid.",
        )


def _mm(length_m: float) -> str:
    return f"{length_m * 1000:.1f} mm"


def count_views(mesh: TriangleMesh, scan: Scan) -> IntArray:
    """In how many views each vertex (V,) faces the camera and has the depth that was measured there."""
    normals = mesh.vertex_normals
    counts = np.zeros(len(mesh.vertices_m), dtype=np.int64)
    for frame in scan.frames:
        counts += _seen_in(frame, scan, mesh.vertices_m, normals)
    return counts


def unseen_share(mesh: TriangleMesh, n_views: IntArray) -> float:
    """Share of the area, but of faces that look down, none of whose corners any view saw (`n_views` (V,))."""
    crosses = _face_crosses(mesh)
    areas = np.linalg.norm(crosses, axis=1)
    counted = crosses[:, 2] > DOWNWARD * areas
    unseen = (n_views[mesh.faces] == 0).all(axis=1)
    total = areas[counted].sum()
    return float(areas[counted & unseen].sum() / total) if total > 0 else 0.0


def _seen_in(frame: RgbdFrame, scan: Scan, points_m: FloatArray, normals: FloatArray) -> BoolArray:
    height, width = frame.depth_m.shape
    x, y, z = transform_points(invert_pose(frame.T_base_camera), points_m).T
    before = z > 0
    safe_z = np.where(before, z, 1.0)
    column = np.round(scan.intrinsics.fx * x / safe_z + scan.intrinsics.cx)
    row = np.round(scan.intrinsics.fy * y / safe_z + scan.intrinsics.cy)
    inside = before & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    measured = np.zeros(len(points_m))
    measured[inside] = frame.depth_m[row[inside].astype(int), column[inside].astype(int)]
    faces_camera = np.einsum("ij,ij->i", normals, frame.T_base_camera[:3, 3] - points_m) > 0
    seen: BoolArray = (measured > 0) & (np.abs(measured - z) < TOLERANCE_M) & faces_camera
    return seen


def _face_crosses(mesh: TriangleMesh) -> FloatArray:
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)
