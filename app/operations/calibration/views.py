"""Views of a scan for this very cell and arm: chosen over all sides of the crop box that the arm reaches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.cell_file import write_views
from app.operations.calibration.provenance import RESULT, latest_result, new_run, now, versions
from core.errors import InputError, MotionError
from core.files import reading, write_json
from core.motion.box_views import choose_box_views
from core.motion.views import ReachableView, ViewTask
from core.progress import Reporter
from core.scan.model import Intrinsics
from core.session import explained
from hardware.cell import read_cell
from hardware.cell.scene import motion_scene, view_task
from hardware.cell.settings import CellSettings

USUAL_VIEWS = 24
FEWEST_VIEWS = 6
"""Fewer show too little of any object."""
_TENTH_MM_RAD = 4


@dataclass(frozen=True)
class CellViews:
    """Views that were chosen.

    Attributes:
        folder: with the record.
        views: in the order in which they are taken.
    """

    folder: Path
    views: tuple[ReachableView, ...]

    @property
    def sentence(self) -> str:
        """How many, from where, how clear."""
        return said_of_views(self.views)


def choose_views(cell_file: Path, reporter: Reporter, n_views: int = USUAL_VIEWS) -> CellViews:
    """Choose views of whatever may fill the crop box, and put them into the cell's file; 5 to 20 s.

    Args:
        cell_file: of the cell.
        reporter: may cancel before anything is written.
        n_views: at most.

    Raises:
        InputError: the cell plays a recording.
        MotionError: the arm reaches too few views.
        SessionError: the disk refuses.
    """
    settings = read_cell(cell_file)
    if settings.robot.kind == "replay":
        raise InputError(f"The {settings.name} plays back a recorded scan; its views are those recorded.")
    reporter.progress("choosing views", 0, 1)
    task = _task(settings, cell_file)
    views = choose_box_views(motion_scene(settings), task, settings.camera.baseline_m, n_views)
    if len(views) < FEWEST_VIEWS:
        raise MotionError(
            f"The arm reaches only {len(views)} views of the crop box; move the platform, correct the crop "
            "box, or choose another home_rad in the cell file."
        )
    reporter.raise_if_cancelled()
    after = [view.joints_rad.round(_TENTH_MM_RAD).tolist() for view in views]
    found = CellViews(new_run(cell_file, step_names.VIEWS), views)
    result: dict[str, Any] = {
        "time": now(),
        "said": found.sentence,
        "before": [list(row) for row in settings.scan.views_rad],
        "after": after,
        "for": views_are_for(settings),
        "versions": versions(),
    }
    with explained(found.folder):
        write_json(found.folder / RESULT, result)
    write_views(cell_file, after)
    return found


def are_in_file(settings: CellSettings, views_rad: Any) -> bool:
    """Whether a cell's file holds these views."""
    held, wanted = np.array(settings.scan.views_rad), np.array(views_rad, dtype=float)
    return held.shape == wanted.shape and bool(np.abs(held - wanted).max() < 10.0**-_TENTH_MM_RAD)


def views_are_for(settings: CellSettings) -> dict[str, Any]:
    """Return what views are chosen by: once it is something else, they have to be chosen anew."""
    return {
        "T_flange_camera": np.array(settings.camera.T_flange_camera).tolist(),
        "home_rad": list(settings.robot.home_rad),
        "place": settings.place.model_dump(mode="json", exclude={"cup_station_m"}),
    }


def are_for(made_for: dict[str, Any], settings: CellSettings) -> bool:
    """Whether views were chosen by what a cell's file has now; older records name the cup's station, too."""
    place = {name: value for name, value in made_for["place"].items() if name != "cup_station_m"}
    return made_for | {"place": place} == views_are_for(settings)


def said_of_views(views: tuple[ReachableView, ...]) -> str:
    """Return how many views there are, from where, and how clear they are."""
    heights = [view.elevation_deg for view in views]
    least_mm = 1000 * min(view.clearance_m for view in views)
    sides = len({round(view.azimuth_deg / 60) % 6 for view in views if view.elevation_deg < 75})
    return (
        f"{len(views)} views at elevations of {min(heights):.0f} to {max(heights):.0f} degrees; from "
        f"{sides} of 6 sides, {least_mm:.0f} mm clear"
    )


def _task(settings: CellSettings, cell_file: Path) -> ViewTask:
    place = settings.place
    low, high = np.array(place.crop_min_m), np.array(place.crop_max_m)
    low[2] = place.platform_height_m
    task = view_task(settings, low, high)
    latest = latest_result(cell_file, step_names.HAND_EYE)
    if latest is None or "intrinsics" not in latest[1]:
        return task
    with reading(latest[0] / RESULT):
        width, height = latest[1]["size_px"]
        view_deg = Intrinsics(*latest[1]["intrinsics"]).field_of_view_deg((width, height))
    return replace(task, field_of_view_deg=view_deg)
