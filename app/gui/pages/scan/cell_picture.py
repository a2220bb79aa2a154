"""The cell as the 3D view shows it, put together in the background. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.gui.views.scene.shapes import box_mesh
from core.motion.kinematics import link_poses

if TYPE_CHECKING:
    from app.gui.views.scene.shapes import Shape
    from core.geometry import FloatArray
    from core.motion.arm_models import ArmModel
    from core.motion.arm_shape import Capsule
    from hardware.cell import CellSettings

_MARGIN_M = 0.04
"""How far the table is shown beyond what stands on it; where it really ends is nobody's concern."""
_TABLE_M = 0.03
_BASE_M = 0.12
"""About the robot's foot."""
_ARM_M = 0.08
"""About its links' middles."""


@dataclass(frozen=True, eq=False)
class CellPicture:
    """What stands in a cell.

    Attributes:
        arm: the model; none in a cell that plays a recorded scan.
        tools: on its flange.
        home_rad: (6,) where it rests.
        reach_m: (2, 3) corners of a box around it at rest and at all views.
        table: the part of it that is of interest.
        platform: where the object stands.
        obstacles: further things to keep away from.
        box_min_m: (3,) lower corner of the box that holds the object.
        box_max_m: (3,) upper corner.
    """

    arm: ArmModel | None
    tools: tuple[Capsule, ...]
    home_rad: FloatArray
    reach_m: FloatArray
    table: Shape
    platform: Shape
    obstacles: tuple[Shape, ...]
    box_min_m: FloatArray
    box_max_m: FloatArray


def picture_cell(cell: CellSettings) -> CellPicture:
    """Return what the 3D view shows of a cell."""
    from hardware.cell.scene import pour_cell

    place = cell.place
    low, high = np.array(place.platform_min_m), np.array(place.platform_max_m)
    known = pour_cell(cell)
    corners = np.array([low, high, place.crop_min_m[:2], place.crop_max_m[:2], [-_BASE_M] * 2, [_BASE_M] * 2])
    top = place.table_height_m
    return CellPicture(
        arm=known.arm if cell.robot.kind != "replay" else None,
        tools=known.tools,
        home_rad=np.array(cell.robot.home_rad),
        reach_m=_reach_m(known.arm, np.array([cell.robot.home_rad, *cell.scan.views_rad])),
        table=box_mesh(
            (*(corners.min(axis=0) - _MARGIN_M), top - _TABLE_M), (*(corners.max(axis=0) + _MARGIN_M), top)
        ),
        platform=box_mesh((*low, top), (*high, place.platform_height_m)),
        obstacles=tuple(box_mesh(box.min_m, box.max_m) for box in cell.obstacles),
        box_min_m=np.array(place.crop_min_m),
        box_max_m=np.array(place.crop_max_m),
    )


def _reach_m(arm: ArmModel, joints_rad: FloatArray) -> FloatArray:
    """Corners (2, 3) of the box that the arm fills at joint angles (N, 6)."""
    middles = link_poses(arm, joints_rad)[..., :3, 3].reshape(-1, 3)
    return np.array([middles.min(axis=0) - _ARM_M, middles.max(axis=0) + _ARM_M])
