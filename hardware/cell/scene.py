"""What the arm must not touch, as the cell file describes it."""

from __future__ import annotations

import numpy as np

from core.motion.arm_models import Capsule, arm_shape, capsule_around_box
from core.motion.clearance import MotionScene, Obstacle, axis_aligned_obstacle
from core.motion.pour.cell import GRIPPER, PourCell
from hardware.cell.settings import ARMS, CellSettings

_TABLE_REACH_M = 1.5
_TABLE_DEPTH_M = 0.5
_STANDS_THERE = frozenset({"base", "shoulder", "upper arm"})
"""The shoulder always rotates nearer to the table than the wanted clearance; the elbow answers for the far
end of the upper arm."""


def motion_scene(cell: CellSettings) -> MotionScene:
    """Return arm, tools and obstacles; the object may fill its whole box."""
    arm = ARMS[cell.robot.model]
    place = cell.place
    whole_box = axis_aligned_obstacle("object's box", place.crop_min_m, place.crop_max_m)
    return MotionScene(arm, arm_shape(arm, _tools(cell)), _obstacles(cell, whole_box))


def board_scene(cell: CellSettings) -> MotionScene:
    """Return arm, tools and obstacles around a flat board, in place of an object."""
    arm = ARMS[cell.robot.model]
    return MotionScene(arm, arm_shape(arm, _tools(cell)), _obstacles(cell))


def pour_cell(cell: CellSettings) -> PourCell:
    """Return what the planning of a pour must know, without the object: its true size is known by then."""
    return PourCell(
        ARMS[cell.robot.model],
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
