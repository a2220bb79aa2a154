"""A first look from a few views high above the platform: how large is the object, and where is it?"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from core.errors import InputError
from core.motion.box_views import in_short_order, views_clear_from_home
from core.motion.views import Dome, choose_spread_views
from core.progress import QuietReporter, Reporter
from core.quality.object_box import ObjectBox, find_object_box
from core.scan.model import CropBox, Intrinsics, crop_box
from hardware.cell import Cell
from hardware.cell.scene import motion_scene, object_space, view_task, with_crop_box
from hardware.cell.settings import CellSettings
from hardware.scanning.control import ScanControl
from hardware.scanning.moving import Moving
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import PlannedView

N_VIEWS = 3
STEEP = Dome(
    elevations_deg=(60, 70, 80),
    azimuths_deg=tuple(range(-180, 180, 30)),
    distances_m=(0.5, 0.6, 0.7, 0.8),
    rolls_deg=tuple(range(-180, 180, 45)),
)
"""Steep, so that little of the platform hides behind a tall object, and its sides are seen from above."""
_BEYOND_M = 0.04
"""So far beyond its space an object is looked for, to tell one that is too large."""
MM = 1000.0

MovingIn = Callable[[Cell], Moving | None]
"""How the arm of a cell is moved; none: as an arm near which nobody can be."""


@dataclass(frozen=True)
class FirstLook:
    """What a first look found.

    Attributes:
        box: of the object; none if there is nothing on the platform.
        intrinsics: of the camera.
        image_size: width and height of its images in pixels.
    """

    box: ObjectBox | None
    intrinsics: Intrinsics
    image_size: tuple[int, int]


def first_look_views(settings: CellSettings) -> tuple[PlannedView, ...]:
    """Choose views that keep clear of all the space an object may fill; none if the arm reaches none.

    Each has a clear straight way from home.
    """
    space = object_space(settings)
    low, high = np.array(space.min_m), np.array(space.max_m)
    scene = motion_scene(settings, space)
    task = view_task(settings, low, high)
    chosen = choose_spread_views(views_clear_from_home(scene, task, STEEP), N_VIEWS)
    ordered = in_short_order(scene, chosen, task)
    return tuple(
        PlannedView(f"first-look-{k}", tuple(view.joints_rad.tolist())) for k, view in enumerate(ordered)
    )


def look_first(
    cell: Cell,
    views: tuple[PlannedView, ...],
    reporter: Reporter,
    control: ScanControl | None = None,
    moving_in: MovingIn = lambda _cell: None,
) -> FirstLook:
    """Take the views and find the object's box.

    Args:
        cell: entered.
        views: what `first_look_views` returned.
        reporter: may cancel it.
        control: pauses it.
        moving_in: how the arm is moved.

    Raises:
        InputError: the object is larger than what can be scanned; the arm has not been near it.
        StageError, Cancelled, DeviceError: see `ScanProcedure.take`.
    """
    settings, space = cell.settings, object_space(cell.settings)
    looking = _watching(cell, space)
    procedure = ScanProcedure(looking, None, QuietReporter(reporter), control, moving=moving_in(looking))
    procedure.take(views)
    box = find_object_box(procedure.volume, settings.place.platform_height_m, space)
    if box is not None and not box.is_within(space):
        raise InputError(_too_large(settings, box, space))
    return FirstLook(box, *procedure.camera_facts())


def _watching(cell: Cell, space: CropBox) -> Cell:
    """The cell with an arm that keeps clear of all of the space, and a crop box a little larger than that."""
    beyond = np.array([_BEYOND_M, _BEYOND_M, 0.0])
    around = crop_box(space.min_m - beyond, np.array(space.max_m) + _BEYOND_M)
    return replace(
        cell, settings=with_crop_box(cell.settings, around), scene=motion_scene(cell.settings, space)
    )


def _too_large(settings: CellSettings, box: ObjectBox, space: CropBox) -> str:
    largest_m = np.array(space.max_m) - space.min_m
    largest_m[2] = space.max_m[2] - settings.place.platform_height_m
    size, largest = (" x ".join(f"{MM * edge:.0f}" for edge in edges) for edges in (box.size_m, largest_m))
    return (
        f"The object of about {size} mm is too large to be scanned in the {settings.name}, or stands too far "
        f"aside: at most {largest} mm above the platform are within reach; put it in the middle, or take a "
        "smaller one."
    )
