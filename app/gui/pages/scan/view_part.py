"""The left of the Scan page: the cell in 3D with the camera's views and what they saw."""

from __future__ import annotations

from collections.abc import Sequence

import numpy.typing as npt
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.gui.pages.scan.cell_picture import CellPicture
from app.gui.views.scene import Frustum, PreparedMesh, Scene3D
from app.jobs.scan_news import ViewNews

ARM, BOX, OBJECT, PLATFORM, TABLE, VIEWS = "arm", "box", "object", "platform", "table", "views"
_OBSTACLE = "obstacle"
_REACH = "reach"
"""Two points nobody sees: with them in view, the arm is, wherever a scan takes it."""
_PLATFORM_OPACITY = 0.35


class ScanView(QWidget):
    """Shows the cell; an imported mesh stands in none, and is shown alone.

    Attributes:
        scene: the 3D view.
        view_picked: the index of the view whose pyramid was clicked.
    """

    view_picked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.scene = Scene3D()
        self.scene.setObjectName("scan_3d")
        self.scene.setAccessibleName(self.tr("The cell in 3D"))
        self.scene.set_empty_text(self.tr("Reading the cell's file …"))
        self.scene.picked.connect(self._pick)
        self._cell: CellPicture | None = None
        self._placed: list[int] = []
        self._is_alone = False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene)

    def show_cell(self, cell: CellPicture) -> None:
        """Show another cell, its arm at rest."""
        self._cell = cell
        if not self._is_alone:
            self._draw_cell(cell)

    def show_alone(self, mesh: PreparedMesh | None) -> None:
        """Show a mesh that stands in no cell; none: the cell again."""
        if mesh is not None:
            if not self._is_alone:
                self.scene.clear()
            self._is_alone = True
            self.scene.set_prepared_mesh(OBJECT, mesh)
            self.scene.fit()
        elif self._is_alone:
            self._is_alone = False
            self.scene.clear()
            if self._cell is not None:
                self._draw_cell(self._cell)

    def show_mesh(self, mesh: PreparedMesh | None) -> None:
        """Show what the views saw."""
        if mesh is None or len(mesh.faces) == 0:
            self.scene.remove(OBJECT)
        else:
            self.scene.set_prepared_mesh(OBJECT, mesh, color="body")

    def show_views(self, views: Sequence[ViewNews], selected: int | None) -> None:
        """Show where the views are taken from; those whose place is not known are left out."""
        frusta = []
        self._placed = []
        for k, view in enumerate(views):
            if view.T_base_camera is not None:
                frusta.append(Frustum(view.name, view.T_base_camera, view.state, k == selected))
                self._placed.append(k)
        self.scene.set_frusta(VIEWS, frusta)

    def bend(self, joints_rad: npt.ArrayLike | None) -> None:
        """Show the arm at joint angles (6,); none: at rest."""
        if self._cell is None or self._is_alone or self._cell.arm is None:
            return
        self.scene.set_joints(ARM, self._cell.home_rad if joints_rad is None else joints_rad)

    def _draw_cell(self, cell: CellPicture) -> None:
        scene = self.scene
        for name in scene.layers():
            if name.startswith(_OBSTACLE) or name in (ARM, _REACH):
                scene.remove(name)
        scene.set_mesh(TABLE, *cell.table, color="raised")
        scene.set_mesh(PLATFORM, *cell.platform, color="accent", opacity=_PLATFORM_OPACITY)
        for k, obstacle in enumerate(cell.obstacles):
            scene.set_mesh(f"{_OBSTACLE} {k}", *obstacle, color="muted")
        scene.set_box(BOX, cell.box_min_m, cell.box_max_m)
        if cell.arm is not None:
            scene.set_arm(ARM, cell.arm, cell.home_rad, tools=cell.tools)
            scene.set_points(_REACH, cell.reach_m, color="scene", size_px=1)
        scene.fit(TABLE, BOX, VIEWS, _REACH)

    def _pick(self, layer: str, index: int) -> None:
        if layer == VIEWS and index < len(self._placed):
            self.view_picked.emit(self._placed[index])
