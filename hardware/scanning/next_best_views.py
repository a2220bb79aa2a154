"""Views that would see the inside of an opening that the scan did not (the paper's future work).

A scan ends with a few of them where its own views left much of the inside unseen.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray
from core.motion.box_views import is_clear_from_home, near_home
from core.motion.views import Dome, ReachableView, ViewTask, reachable_views
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import QuietReporter, Reporter
from core.quality.next_views import (
    DepthCamera,
    bottom_of,
    propose_views,
    revealed_voxels,
    sample_of,
    worth_of,
)
from core.reconstruction.fusion import fuse_object
from core.reconstruction.tsdf import TsdfVolume
from core.reconstruction.unseen import UnseenInside, find_unseen_inside
from core.scan.model import Scan
from hardware.cell import Cell
from hardware.cell.scene import view_task
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import Joints, ViewState, name_views

STAGE = "looking again"
MOST_VIEWS = 6
MOST_VIEWS_FOR_VERDICT = 16
"""More are taken while the verdict hangs on them: while there may be a hole in the bottom, ..."""
MOSTLY_UNSEEN_SHARE = 0.5
"""... or more of the inside is unseen than seen."""
VIEWS_A_ROUND = 2
"""What these reveal changes what the others would, so the rest is chosen anew, ..."""
LATER_VIEWS_A_ROUND = 5
"""... and what comes after `MOST_VIEWS` at once: it changes less, and an operator confirms each round."""
UNSEEN_SHARE = 0.04
"""A scan that left more than this share of the inside unseen looks into it; or a way through the bottom."""
SAMPLE, SPARSE_SAMPLE = 5000, 1000
"""How many voxels of a large hidden region are looked for; fewer while candidates are thousands."""
SAME_POSE = 2e-3
"""Poses of the camera that differ by no more, in metres and in the axes' components, are one."""
INTO_OPENINGS = Dome(
    elevations_deg=(20, 30, 40, 50, 56, 62, 68, *range(70, 91, 2)),
    azimuths_deg=tuple(range(-180, 180, 20)),
    distances_m=(0.45, 0.5, 0.55, 0.6, 0.65, 0.7),
    rolls_deg=tuple(range(-180, 180, 45)),
)
"""The floor of a narrow opening is visible within a few degrees only, to camera and projector alike, so steep
views come densely, from afar and with every roll. Below a lid that is half open only flat ones look."""


def object_volume(scan: Scan, reporter: Reporter) -> TsdfVolume | None:
    """Fuse a scan as the reconstruction will, which alone knows what it takes for seen; 1 to 4 s.

    Plain fusion in coarse voxels takes a few millimetres more behind a wall for solid, and half of a narrow
    mouth. None if there is no object.

    Raises:
        Cancelled: on request.
    """
    try:
        return fuse_object(scan, ReconstructionParameters(), QuietReporter(reporter)).volume
    except StageError:
        return None


def propose(
    cell: Cell, scan: Scan, volume: TsdfVolume, unseen: UnseenInside, most: int = MOST_VIEWS
) -> list[tuple[Joints, float]]:
    """Return up to `most` views, each with the share of what is hidden that it reveals, best first.

    Each has a clear straight way from home, so that it is reached from wherever the arm is.

    Args:
        cell: with its arm and obstacles.
        scan: everything that was taken.
        volume: all of it, fused (see `object_volume`).
        unseen: where the views ended in that volume.
        most: how many.
    """
    height_m = cell.settings.place.platform_height_m
    region = np.argwhere(unseen.in_volume(unseen.region))
    if len(region) == 0:
        return []
    camera = _depth_camera(cell, scan)
    task = _task(cell, scan, camera, volume.centers_m(region).mean(axis=0))
    views = _not_taken(_one_each(near_home(reachable_views(cell.scene, task, INTO_OPENINGS), task)), scan)
    if not views:
        return []
    sparse, sample = sample_of(region, SPARSE_SAMPLE), sample_of(region, SAMPLE)
    revealed = revealed_voxels(volume, sparse, height_m, _poses(views), camera)
    best = _best_of_each_direction(views, worth_of(revealed, bottom_of(volume, sparse, height_m)).tolist())

    def can_take(k: int) -> bool:
        return is_clear_from_home(cell.scene, task, best[k])

    chosen = propose_views(volume, sample, height_m, _poses(best), camera, most, can_take)
    return [
        (tuple(best[one.index].joints_rad.tolist()), one.n_revealed_voxels / len(sample)) for one in chosen
    ]


def _task(cell: Cell, scan: Scan, camera: DepthCamera, target_m: FloatArray) -> ViewTask:
    place = cell.settings.place
    return replace(
        view_task(cell.settings, np.array(place.crop_min_m), np.array(place.crop_max_m)),
        target_m=target_m,
        field_of_view_deg=scan.intrinsics.field_of_view_deg((camera.width_px, camera.height_px)),
    )


def _poses(views: list[ReachableView]) -> FloatArray:
    """`T_base_camera` of each (N, 4, 4)."""
    return np.array([view.T_base_camera for view in views]).reshape(-1, 4, 4)


def _depth_camera(cell: Cell, scan: Scan) -> DepthCamera:
    height, width = scan.frames[0].depth_m.shape
    settings = cell.settings.camera
    return DepthCamera(scan.intrinsics, width, height, settings.baseline_m, settings.min_range_m)


def look_inside(cell: Cell, procedure: ScanProcedure, reporter: Reporter, n_own: int) -> int:
    """Take a few views into openings of whose inside the scan left too much unseen; return how many.

    Of an interrupted scan those that were chosen already are taken first, and count.

    Args:
        cell: of the procedure.
        procedure: which has taken the scan's own views.
        reporter: learns that views are being chosen.
        n_own: how many these are.

    Raises:
        StageError, Cancelled, DeviceError, SessionError: see `ScanProcedure.take`.
    """
    if not cell.settings.scan.look_inside:
        return 0
    chosen_before = procedure.records[n_own:]
    procedure.take([record.view for record in chosen_before if record.state is ViewState.PENDING])
    return take_next_best_views(cell, procedure, reporter, UNSEEN_SHARE, len(chosen_before))


def take_next_best_views(
    cell: Cell, procedure: ScanProcedure, reporter: Reporter, least_share: float = 0.0, n_before: int = 0
) -> int:
    """Propose views and take them, a few at a time; return how many.

    Args:
        cell: of the procedure.
        procedure: which has taken other views.
        reporter: learns that views are being chosen.
        least_share: of the inside; while no more of it is unseen, and the unseen is no way through its
            bottom, none is taken.
        n_before: how many such views the scan has already; they count.
    """
    n_now, height_m = n_before, cell.settings.place.platform_height_m
    if not find_unseen_inside(procedure.volume, height_m).region.any():
        return 0
    reporter.progress(STAGE, 0, 1)
    while (volume := object_volume(scan := procedure.scan(), reporter)) is not None:
        unseen = find_unseen_inside(volume, height_m)
        most = _most_views(volume, unseen, least_share)
        a_round = VIEWS_A_ROUND if n_now < MOST_VIEWS else LATER_VIEWS_A_ROUND
        proposals = propose(cell, scan, volume, unseen, min(a_round, most - n_now)) if most > n_now else []
        if not proposals:
            break
        procedure.take(name_views([joints for joints, _ in proposals], first=len(procedure.records)))
        n_now += len(proposals)
        reporter.progress(STAGE, 0, 1)
    return n_now - n_before


def _most_views(volume: TsdfVolume, unseen: UnseenInside, least_share: float) -> int:
    """How many views are worth taking: most where the verdict hangs on what was not seen."""
    share = unseen.room_share(volume.voxel_m)
    if share > MOSTLY_UNSEEN_SHARE or unseen.way_through(volume) is not None:
        return MOST_VIEWS_FOR_VERDICT
    return MOST_VIEWS if share > least_share else 0


def _not_taken(views: list[ReachableView], scan: Scan) -> list[ReachableView]:
    """Those from which the scan has no view: what one did not show, it does not show the second time."""
    taken = np.array([frame.T_base_camera for frame in scan.frames])
    return [view for view in views if np.abs(taken - view.T_base_camera).max(axis=(1, 2)).min() > SAME_POSE]


def _best_of_each_direction(views: list[ReachableView], worth: list[int]) -> list[ReachableView]:
    """The view that is worth most in each direction; those that are worth nothing are left out."""
    best: dict[tuple[float, float], tuple[int, ReachableView]] = {}
    for one, view in zip(worth, views, strict=True):
        direction = view.elevation_deg, view.azimuth_deg
        if one > 0 and (direction not in best or one > best[direction][0]):
            best[direction] = one, view
    return [view for _, view in best.values()]


def _one_each(views: list[ReachableView]) -> list[ReachableView]:
    """The best configuration of each camera pose."""
    best: dict[bytes, ReachableView] = {}
    for view in views:
        best.setdefault(np.round(view.T_base_camera, 6).tobytes(), view)
    return list(best.values())
