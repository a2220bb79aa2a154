"""The cell's arm and furniture, as the 3D views of the Scan and the Robot page show them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.gui.views.scene.shapes import box_mesh

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
_OBSTACLE = "obstacle"


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
    """

    arm: ArmModel
    tools: tuple[Capsule, ...]
    home_rad: FloatArray
    table: Shape
    platform: Shape
    obstacles: tuple[Shape, ...]

    def draw_furniture(self, scene: Scene3D, table: str, platform: str, platform_opacity: float) -> None:
        """Draw everything but the arm in place of what stood there before; `table`, `platform`: colours."""
        for name in [name for name in scene.layers() if name.startswith(_OBSTACLE)]:
            scene.remove(name)
        scene.set_mesh("table", *self.table, color=table)
        scene.set_mesh("platform", *self.platform, color=platform, opacity=platform_opacity)
        for k, obstacle in enumerate(self.obstacles):
            scene.set_mesh(f"{_OBSTACLE} {k}", *obstacle, color="muted", opacity=0.6)


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
    )
