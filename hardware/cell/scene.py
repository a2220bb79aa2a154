"""What the arm must not touch, as the cell file describes it."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import Capsule, arm_shape, capsule_around_box
from core.motion.clearance import MotionScene, Obstacle, axis_aligned_obstacle
from core.motion.pour.cell import GRIPPER, PourCell
from core.motion.views import ViewTask
from core.scan.model import CropBox, crop_box
from hardware.cell.settings import CellSettings

OBJECT_BOX = "object's box"
_TABLE_REACH_M = 1.5
_TABLE_DEPTH_M = 0.5
_STANDS_THERE = frozenset({"base", "shoulder", "upper arm"})
"""The shoulder always rotates nearer to the table than the wanted clearance; the elbow answers for the far
end of the upper arm."""


def motion_scene(cell: CellSettings, object_box: CropBox | None = None) -> MotionScene:
    """Return arm, tools and obstacles; the object may fill its whole box, by default the crop box."""
    arm = cell.robot.arm
    box = object_box or cell.place.crop_box
    whole_box = axis_aligned_obstacle(OBJECT_BOX, box.min_m, box.max_m)
    return MotionScene(arm, arm_shape(arm, _tools(cell)), _obstacles(cell, whole_box))


def plans_views(cell: CellSettings) -> bool:
    """Whether views are planned for an object that the cell's own do not suit; a recording has its own."""
    return cell.scan.views == "planned" and cell.robot.kind != "replay"


def object_space(cell: CellSettings) -> CropBox:
    """Return where an object may stand: the crop box; with planned views all of the platform, and higher."""
    place = cell.place
    if not plans_views(cell):
        return place.crop_box
    low, high = np.array(place.crop_min_m), np.array(place.crop_max_m)
    low[:2] = np.minimum(low[:2], place.platform_min_m)
    top_m = place.platform_height_m + cell.scan.highest_object_m
    return crop_box(low, np.maximum(high, [*place.platform_max_m, top_m]))


def with_crop_box(cell: CellSettings, box: CropBox) -> CellSettings:
    """Return the cell with another crop box."""
    corners = {"crop_min_m": box.min_m, "crop_max_m": box.max_m}
    return cell.model_copy(update={"place": cell.place.model_copy(update=corners)})


def view_task(cell: CellSettings, low_m: FloatArray, high_m: FloatArray) -> ViewTask:
    """Return the task of looking at a box's middle with the cell's camera; its corners are (3,)."""
    return ViewTask(
        T_flange_camera=cell.camera.pose,
        target_m=(low_m + high_m) / 2,
        box_min_m=low_m,
        box_max_m=high_m,
        home_rad=np.array(cell.robot.home_rad),
        min_range_m=cell.camera.min_range_m,
        min_clearance_m=cell.scan.min_clearance_m,
    )


def board_scene(cell: CellSettings) -> MotionScene:
    """Return arm, tools and obstacles around a flat board, in place of an object."""
    arm = cell.robot.arm
    return MotionScene(arm, arm_shape(arm, _tools(cell)), _obstacles(cell))


def pour_cell(cell: CellSettings) -> PourCell:
    """Return what the planning of a pour must know, without the object: its true size is known by then."""
    return PourCell(
        cell.robot.arm,
        _tools(cell),
        tuple(_obstacles(cell)),
        np.array(cell.robot.home_rad),
        np.array(cell.place.cup_station_m),
        cell.gripper.grasp_pose,
        cell.gripper.grip_height_m,
        cell.motion,
    )


def _tools(cell: CellSettings) -> tuple[Capsule, ...]:
    gripper, camera = cell.gripper, cell.camera
    # A capsule reaches one radius beyond its segment's end.
    tip_m = max(gripper.length_m - gripper.radius_m, 0.0)
    return (
        Capsule(GRIPPER, 6, (0.0, 0.0, 0.0), (0.0, 0.0, tip_m), gripper.radius_m),
        capsule_around_box("camera", camera.pose, camera.size_m),
    )


def _obstacles(cell: CellSettings, *on_platform: Obstacle) -> list[Obstacle]:
    place = cell.place
    top = place.table_height_m
    low, high = place.platform_min_m, place.platform_max_m
    reach = _TABLE_REACH_M
    return [
        axis_aligned_obstacle(
            "table", (-reach, -reach, top - _TABLE_DEPTH_M), (reach, reach, top), _STANDS_THERE
        ),
        axis_aligned_obstacle("platform", (*low, top), (*high, place.platform_height_m)),
        *on_platform,
        *(axis_aligned_obstacle(box.name, box.min_m, box.max_m) for box in cell.obstacles),
    ]
