"""Views that would see the inside of an opening that the scan did not (the paper's future work)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.geometry import FloatArray
from core.motion.views import Dome, ReachableView, reachable_views
from core.quality.cavity import find_hidden_cavity
from core.quality.next_views import DepthCamera, propose_views
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import Intrinsics
from hardware.cell import Cell
from hardware.cell.scene import view_task
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import Joints, name_views

MOST_VIEWS = 6
VIEWS_A_ROUND = 2
"""What these reveal changes what the others would, so the rest is chosen anew."""
INTO_OPENINGS = Dome(
    elevations_deg=(50, 56, 62, 68, *range(70, 91, 2)),
    azimuths_deg=tuple(range(-180, 180, 20)),
    distances_m=(0.45, 0.5, 0.55, 0.6, 0.65, 0.7),
    rolls_deg=tuple(range(-180, 180, 45)),
)
"""The floor of a narrow opening is visible within a few degrees only, to camera and projector alike, so steep
views come densely, from afar and with every roll."""


def propose(
    cell: Cell,
    volume: TsdfVolume,
    intrinsics: Intrinsics,
    image_size: tuple[int, int],
    most: int = MOST_VIEWS,
) -> list[tuple[Joints, int]]:
    """Return up to `most` reachable views, each with how many unseen voxels it reveals, best first.

    Args:
        cell: with its arm and obstacles.
        volume: everything fused so far.
        intrinsics: of the camera.
        image_size: width and height in pixels.
        most: how many.
    """
    height_m = cell.settings.place.platform_height_m
    cavity = find_hidden_cavity(volume, height_m)
    if len(cavity.region) == 0:
        return []
    place = cell.settings.place
    hidden_m: FloatArray = volume.centers_m(cavity.region)
    task = replace(
        view_task(cell.settings, np.array(place.crop_min_m), np.array(place.crop_max_m)),
        target_m=hidden_m.mean(axis=0),
        field_of_view_deg=intrinsics.field_of_view_deg(image_size),
    )
    views = reachable_views(cell.scene, task, INTO_OPENINGS)
    different = _one_each(views)
    if not different:
        return []
    poses = np.array([view.T_base_camera for view in different])
    width, height = image_size
    settings = cell.settings.camera
    camera = DepthCamera(intrinsics, width, height, settings.baseline_m, settings.min_range_m)
    proposed = propose_views(volume, cavity, height_m, poses, camera, most)
    return [(tuple(different[p.index].joints_rad.tolist()), p.n_revealed_voxels) for p in proposed]


def take_next_best_views(cell: Cell, procedure: ScanProcedure) -> int:
    """Propose views and take them, a few at a time, at most `MOST_VIEWS`; return how many."""
    taken = 0
    while taken < MOST_VIEWS:
        proposals = propose(
            cell, procedure.volume, *procedure.camera_facts(), min(VIEWS_A_ROUND, MOST_VIEWS - taken)
        )
        if not proposals:
            break
        procedure.take(name_views([joints for joints, _ in proposals], first=len(procedure.records)))
        taken += len(proposals)
    return taken


def _one_each(views: tuple[ReachableView, ...]) -> list[ReachableView]:
    """The best configuration of each camera pose."""
    best: dict[bytes, ReachableView] = {}
    for view in views:
        best.setdefault(np.round(view.T_base_camera, 6).tobytes(), view)
    return list(best.values())
