"""From where an object is scanned: the cell's fixed views, or views planned for its box (decision 0023)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import MotionError
from core.motion.box_views import choose_box_views
from core.progress import Reporter
from core.quality.object_box import ObjectBox
from core.scan.model import CropBox, crop_box
from hardware.cell import Cell
from hardware.cell.scene import OBJECT_BOX, motion_scene, plans_views, view_task, with_crop_box
from hardware.cell.settings import CellSettings
from hardware.scanning.control import ScanControl
from hardware.scanning.first_look import FirstLook, MovingIn, first_look_views, look_first
from hardware.scanning.procedure import FEWEST_VIEWS
from hardware.scanning.views import ScanPlan

N_VIEWS = 24
MARGIN_M = 0.02
"""Around what the first look saw: for its noise and errors of pose, and for what it did not see."""


def plan_scan(
    cell: Cell,
    reporter: Reporter,
    control: ScanControl | None = None,
    moving_in: MovingIn = lambda _cell: None,
) -> ScanPlan:
    """Decide from where the object is scanned; with planned views the arm takes a first look.

    Args:
        cell: entered.
        reporter: receives warnings, and may cancel it.
        control: pauses the first look.
        moving_in: how the arm is moved.

    Raises:
        InputError: the object is larger than what can be scanned; nothing moved but for the first look.
        MotionError: the arm reaches too few views of an object of this size.
        StageError, Cancelled, DeviceError: see `ScanProcedure.take`.
    """
    settings = cell.settings
    if not plans_views(settings):
        return fixed_plan(cell)
    views = first_look_views(settings)
    if not views:
        reporter.warn(
            "The arm reaches no view high enough for a first look, so the views of the cell file are taken; "
            "choose another home_rad there, or lower highest_object_m."
        )
        return fixed_plan(cell)
    look = look_first(cell, views, reporter, control, moving_in)
    if look.box is None or (look.box.is_within(settings.place.crop_box) and _fixed_views_suit(settings)):
        return fixed_plan(cell)
    return _planned(cell, look, look.box)


def fixed_plan(cell: Cell) -> ScanPlan:
    """The views and the crop box of the cell file, whose whole crop box the object may fill."""
    box = cell.settings.place.crop_box
    return ScanPlan(cell.views_rad, box, box)


def cell_for_plan(cell: Cell, plan: ScanPlan) -> Cell:
    """Return the cell as a plan has it: its crop box, and an arm that keeps clear of its keep-out box."""
    settings = with_crop_box(cell.settings, plan.crop_box)
    return replace(cell, settings=settings, scene=motion_scene(settings, plan.keep_out))


def _fixed_views_suit(settings: CellSettings) -> bool:
    """Whether none of them is blocked by the crop box; what else blocks one is for the operator to see."""
    joints = np.array(settings.scan.views_rad)
    least_m = settings.scan.min_clearance_m
    blocked = motion_scene(settings).clearance(joints)
    too_near = np.flatnonzero(blocked.distance_m < least_m).tolist()
    return all(OBJECT_BOX not in blocked.nearest(k) for k in too_near)


def _planned(cell: Cell, look: FirstLook, box: ObjectBox) -> ScanPlan:
    settings = cell.settings
    low, high = box.min_m - [MARGIN_M, MARGIN_M, 0], box.max_m + MARGIN_M
    low[2] = settings.place.crop_min_m[2]
    keep_out = crop_box(low, high)
    task = replace(
        view_task(settings, box.min_m, box.max_m),
        field_of_view_deg=look.intrinsics.field_of_view_deg(look.image_size),
    )
    views = choose_box_views(motion_scene(settings, keep_out), task, settings.camera.baseline_m, N_VIEWS)
    if len(views) < FEWEST_VIEWS:
        size = " x ".join(f"{1000 * edge:.0f}" for edge in box.size_m)
        raise MotionError(
            f"The arm reaches only {len(views)} views of the object of about {size} mm; put it farther from "
            "the arm's base, or take a smaller one."
        )
    views_rad = tuple(tuple(view.joints_rad.tolist()) for view in views)
    return ScanPlan(views_rad, _around_both(settings.place.crop_box, keep_out), keep_out)


def _around_both(one: CropBox, other: CropBox) -> CropBox:
    return crop_box(np.minimum(one.min_m, other.min_m), np.maximum(one.max_m, other.max_m))
