"""The cell's arm and furniture, as the 3D views of several pages show them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.gui.views.scene.occlusion import surface_points_m
from app.gui.views.scene.shapes import box_mesh, cylinder_mesh
from core.motion.kinematics import link_poses
from core.parameters.bodies import CupParameters

if TYPE_CHECKING:
    import numpy.typing as npt

    from app.gui.views.scene import Scene3D
    from app.gui.views.scene.shapes import Shape
    from core.geometry import FloatArray
    from core.motion.arm_models import ArmModel, Capsule
    from hardware.cell import CellSettings

_TABLE_M = 0.03
_BASE_M = 0.12
"""About the robot's foot."""
_CUP_M = 0.04
"""About the cup's foot."""
_FOOT_M = 0.075
"""The foot's radius."""
_OBSTACLE = "obstacle"
_GRID_M = 0.02
_N_CASTERS = 8_000
_MARGIN_M = 0.04
_ARM_M = 0.08
"""About the middles of the arm's links."""
_LIFT_M = 0.0008
"""A ground on a box is that much above it, so that the two do not flicker."""


@dataclass(frozen=True, eq=False)
class CellModel:
    """What stands in a cell, in the robot's base frame.

    Attributes:
        arm: the model.
        tools: on its flange.
        home_rad: (6,) where it rests.
        table: the part of it that is shown.
        platform: where the object stands.
        obstacles: further things to keep away from.
        cup: at its station.
    """

    arm: ArmModel
    tools: tuple[Capsule, ...]
    home_rad: FloatArray
    table: Shape
    platform: Shape
    obstacles: tuple[Shape, ...]
    cup: Shape

    def draw_furniture(self, scene: Scene3D) -> None:
        """Draw everything but the arm in place of what stood there before."""
        for name in [name for name in scene.layers() if name.startswith(_OBSTACLE)]:
            scene.remove(name)
        scene.set_mesh("table", *self.table, color="ground")
        scene.set_mesh("platform", *self.platform, color="raised")
        for k, obstacle in enumerate(self.obstacles):
            scene.set_mesh(f"{_OBSTACLE} {k}", *obstacle, color="muted", opacity=0.6)
        standing = [self.platform, *self.obstacles, cylinder_mesh(_FOOT_M, _BASE_M)]
        casters = [surface_points_m(*shape, _N_CASTERS) for shape in standing]
        _draw_top(scene, "table top", self.table, np.vstack(casters), "ground", _GRID_M)

    def draw_platform_top(self, scene: Scene3D, casters_m: npt.ArrayLike) -> None:
        """Draw the platform's top, shaded by points (N, 3) of what stands on it."""
        _draw_top(scene, "platform top", self.platform, casters_m, "raised", 0.0)


def _draw_top(
    scene: Scene3D, name: str, box: Shape, casters_m: npt.ArrayLike, color: str, grid_m: float
) -> None:
    """Draw the upper side of a box as a ground."""
    low, high = box[0].min(axis=0), box[0].max(axis=0)
    center = [*(low + high)[:2] / 2, high[2] + _LIFT_M]
    half = (high - low)[:2] / 2
    scene.set_ground(name, center, half, casters_m, grid_m=grid_m, fades=False, color=color)


def cell_model(cell: CellSettings, on_table_m: npt.ArrayLike, margin_m: float) -> CellModel:
    """Put a cell together.

    Args:
        cell: its settings.
        on_table_m: (N, 2) further points that the table reaches to, besides platform and robot.
        margin_m: how far the table is shown beyond all of these; where it really ends is not known.
    """
    from hardware.cell.scene import pour_cell

    place, known = cell.place, pour_cell(cell)
    low, high = np.array(place.platform_min_m), np.array(place.platform_max_m)
    corners = np.vstack([low, high, [-_BASE_M] * 2, [_BASE_M] * 2, on_table_m])
    top = place.table_height_m
    return CellModel(
        arm=known.arm,
        tools=known.tools,
        home_rad=known.home_rad,
        table=box_mesh(
            (*(corners.min(axis=0) - margin_m), top - _TABLE_M), (*(corners.max(axis=0) + margin_m), top)
        ),
        platform=box_mesh((*low, top), (*high, place.platform_height_m)),
        obstacles=tuple(box_mesh(box.min_m, box.max_m) for box in cell.obstacles),
        cup=_standing_cup(cell),
    )


def _standing_cup(cell: CellSettings) -> Shape:
    cup = cell.cup or CupParameters()
    foot_radius_m = cup.base_inner_radius_m + cup.wall_m
    vertices, faces = cylinder_mesh(foot_radius_m, cup.length_m, cup.mouth_radius_m)
    return vertices + np.array(cell.place.cup_station_m), faces


@dataclass(frozen=True, eq=False)
class ShownCell:
    """What is shown of a cell.

    Attributes:
        model: arm and furniture.
        has_arm: whether something moves; a cell that plays a recorded scan has no arm.
        reach_m: (2, 3) corners of a box around the arm at rest and at all views.
        box_min_m: (3,) lower corner of the box that holds the object.
        box_max_m: (3,) upper corner.
    """

    model: CellModel
    has_arm: bool
    reach_m: FloatArray
    box_min_m: FloatArray
    box_max_m: FloatArray


def load_shown_cell(cell: CellSettings) -> ShownCell:
    """Put the cell together."""
    low_m, high_m = np.array(cell.place.crop_min_m), np.array(cell.place.crop_max_m)
    foot_m = np.array(cell.place.cup_station_m)[:2]
    model = cell_model(cell, [low_m[:2], high_m[:2], foot_m - _CUP_M, foot_m + _CUP_M], _MARGIN_M)
    joints_rad = np.array([cell.robot.home_rad, *cell.scan.views_rad])
    middles_m = link_poses(model.arm, joints_rad)[..., :3, 3].reshape(-1, 3)
    reach_m = np.array([middles_m.min(axis=0) - _ARM_M, middles_m.max(axis=0) + _ARM_M])
    return ShownCell(model, cell.robot.kind != "replay", reach_m, low_m, high_m)
