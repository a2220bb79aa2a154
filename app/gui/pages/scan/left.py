"""The left of the Scan page: the cell in 3D, the verdict, and the views as thumbnails."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.cell_model import ShownCell
from app.gui.pages.page import SplitView
from app.gui.theme import GRID_PX
from app.gui.views.frustum_legend import FrustumLegend
from app.gui.views.labels import text_label
from app.gui.views.scene import Frustum, PreparedMesh, Scene3D
from app.gui.views.scene.arm import ArmLooks
from app.gui.views.state_mark import State, StateMark
from app.gui.views.thumbnails import ThumbnailGrid
from app.jobs.scan_events import ViewProgress
from core.geometry import FloatArray
from core.scan.model import CropBox

_AT_HOME_RAD = 0.01
_ARM, _BOX, _OBJECT, _REACH, _TABLE, _VIEWS = "arm", "box", "object", "reach", "table", "views"
_GROUND_SIZES = 1.6
"""Half the side of an imported mesh's ground, as a share of the mesh's diagonal."""
_VERDICT_PX = 10 * GRID_PX
"""Kept whatever is said: if it changed, the 3D view would jump, and be drawn anew."""
_MOST_REASONS = 3
"""Shown; further ones are in the tooltip."""
_CELL_PX = (58, 63)
"""Of a thumbnail at its smallest, with the line for its state."""
_SHARE = 0.2
"""Of the height, for the thumbnails, if they do not need more."""
_SIDE_PX, _SIDE_SHARE = 320, 0.25
"""Width of what is at the right: at least, and of the page's."""


class ScanLeft(QWidget):
    """All that is looked at.

    The thumbnails lie below the view: in the side panel they would leave no space for the camera's images
    in a window of 1280 x 800.

    Attributes:
        view: in 3D.
        verdict: below it.
        grid: of thumbnails.
        view_picked: the index of the view that was clicked, in 3D or in small.
    """

    view_picked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.view = ScanView()
        self.verdict = VerdictView()
        self.grid = ThumbnailGrid()
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self._column.addWidget(self.view, 1)
        self._column.addWidget(self.verdict)
        below = QVBoxLayout()
        below.setContentsMargins(GRID_PX, 0, 0, GRID_PX)
        below.addWidget(self.grid)
        self._column.addLayout(below)
        self.view.view_picked.connect(self.view_picked)
        self.grid.selected.connect(self.view_picked)

    def fit_thumbnails(self) -> None:
        """Give the thumbnails as many rows as they need, after their number has changed."""
        n = len(self.grid.items)
        self.grid.setVisible(n > 0)
        if n:
            columns = max((self.width() - GRID_PX) // _CELL_PX[0], 1)
            needed = -(-n // columns) * _CELL_PX[1]
            self.grid.setFixedHeight(round(max(min(needed, self.height() / 3), _SHARE * self.height())))

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit_thumbnails()


class ScanSplit(SplitView):
    """Leaves the left as much as two rows of thumbnails want in a window of 1280 x 800; both grow with it."""

    _was_shown = False

    @override
    def reset(self) -> None:
        self.setStretchFactor(0, 3)
        self.setStretchFactor(1, 1)
        side_px = max(_SIDE_PX, round(_SIDE_SHARE * self.width()))
        self.setSizes([max(self.width() - side_px, side_px), side_px])

    @override
    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self._was_shown:
            self._was_shown = True
            self.reset()


class ScanView(QWidget):
    """Shows the cell; an imported mesh has no place in it, and is shown alone.

    Attributes:
        scene: the 3D view.
        legend: of the pyramids in it.
        view_picked: the index of the view whose pyramid was clicked.
    """

    view_picked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.scene = Scene3D()
        self.scene.setObjectName("scan_3d")
        self.scene.setAccessibleName(self.tr("The cell in 3D"))
        self.scene.set_empty_text(self.tr("Reading the cell file …"))
        self.scene.picked.connect(self._pick)
        self.legend = FrustumLegend(self)
        self.legend.move(GRID_PX, GRID_PX)
        self._cell: ShownCell | None = None
        self._box: CropBox | None = None
        self._placed: list[int] = []
        self._is_alone = False
        self._joints_rad: FloatArray | None = None
        self._is_connected = False
        self._casters_m: npt.NDArray[np.float32] = np.empty((0, 3), dtype=np.float32)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene)

    def show_cell(self, cell: ShownCell) -> None:
        """Show another cell, its arm at rest."""
        self._cell = cell
        self._joints_rad, self._is_connected = None, False
        if not self._is_alone:
            self._draw_cell(cell)

    def show_alone(self, mesh: PreparedMesh | None) -> None:
        """Show an imported mesh; none: the cell again."""
        if mesh is not None:
            if not self._is_alone:
                self.scene.clear()
            self._is_alone = True
            self.scene.set_prepared_mesh(_OBJECT, mesh)
            low, high = mesh.vertices_m.min(axis=0), mesh.vertices_m.max(axis=0)
            half_m = _GROUND_SIZES * float(np.linalg.norm(high - low))
            middle = [*(low + high)[:2] / 2, low[2]]
            self.scene.set_ground("ground", middle, [half_m] * 2, mesh.vertices_m)
            self.scene.fit()
        elif self._is_alone:
            self._is_alone = False
            self.scene.clear()
            if self._cell is not None:
                self._draw_cell(self._cell)

    def show_box(self, box: CropBox | None) -> None:
        """Show the box that a scan's plan laid around the object; none: the cell's."""
        if box == self._box:
            return
        self._box = box
        if self._cell is not None and not self._is_alone:
            self._draw_box(self._cell)

    def show_mesh(self, mesh: PreparedMesh | None) -> None:
        """Show what the views saw."""
        if mesh is None or len(mesh.faces) == 0:
            self.scene.remove(_OBJECT)
            self._casters_m = self._casters_m[:0]
        else:
            self.scene.set_prepared_mesh(_OBJECT, mesh, color="body")
            self._casters_m = mesh.vertices_m
        if self._cell is not None and not self._is_alone:
            self._cell.model.draw_platform_top(self.scene, self._casters_m)

    def show_views(self, views: Sequence[ViewProgress], selected: int | None) -> None:
        """Show where the views are taken from; those whose place is not known are left out."""
        frusta = []
        self._placed = []
        for k, view in enumerate(views):
            if view.T_base_camera is not None:
                frusta.append(Frustum(view.name, view.T_base_camera, view.state, k == selected))
                self._placed.append(k)
        self.scene.set_frusta(_VIEWS, frusta)
        self.legend.show_states(frustum.state for frustum in frusta)
        self.legend.raise_()

    def show_arm(self, joints_rad: FloatArray | None, *, is_connected: bool) -> None:
        """Show the arm as it is now, or see-through where it was last seen, unless it had come home.

        Args:
            joints_rad: (6,) as it reported them last; none: it is drawn at home.
            is_connected: whether it reports them now.
        """
        former, self._joints_rad, self._is_connected = self.arm_looks, joints_rad, is_connected
        cell = self._cell
        if cell is None or not cell.has_arm or self._is_alone:
            return
        if self.arm_looks == former and joints_rad is not None:
            self.scene.set_joints(_ARM, joints_rad)
        else:
            self._draw_arm(cell)

    @property
    def arm_looks(self) -> ArmLooks:
        """How the arm is drawn: see-through while nobody knows where it is now."""
        if self._is_connected or self._joints_rad is None or self._cell is None:
            return "solid"
        is_home = np.allclose(self._joints_rad, self._cell.model.home_rad, atol=_AT_HOME_RAD)
        return "solid" if is_home else "ghost"

    def _draw_arm(self, cell: ShownCell) -> None:
        model = cell.model
        joints_rad = model.home_rad if self._joints_rad is None else self._joints_rad
        self.scene.set_arm(_ARM, model.arm, joints_rad, tools=model.tools, looks=self.arm_looks)

    def _draw_cell(self, cell: ShownCell) -> None:
        scene, model = self.scene, cell.model
        scene.remove(_ARM)
        scene.remove(_REACH)
        model.draw_furniture(scene)
        model.draw_platform_top(scene, self._casters_m)
        self._draw_box(cell)
        if cell.has_arm:
            self._draw_arm(cell)
            # Two points nobody sees: with them in view, the arm is, wherever a scan takes it.
            scene.set_points(_REACH, cell.reach_m, color="scene", size_px=1)
        scene.fit(_TABLE, _BOX, _VIEWS, _REACH)

    def _draw_box(self, cell: ShownCell) -> None:
        box = self._box
        corners = (cell.box_min_m, cell.box_max_m) if box is None else (box.min_m, box.max_m)
        self.scene.set_box(_BOX, *corners)

    def _pick(self, layer: str, index: int) -> None:
        if layer == _VIEWS and index < len(self._placed):
            self.view_picked.emit(self._placed[index])


class VerdictView(QWidget):
    """A sentence with a mark, its reasons, and a button for what to do.

    Attributes:
        action: does what the sentence asks for; shown by the page if there is something to do.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("scan_verdict")
        self.setMinimumHeight(_VERDICT_PX)
        self._mark = StateMark("empty")
        self._headline = text_label("headline", "verdict")
        self._details = text_label("details")
        self.action = QPushButton()
        self.action.setObjectName("verdict_action")
        below = QHBoxLayout()
        below.setSpacing(2 * GRID_PX)
        below.addWidget(self._details, 1)
        below.addWidget(self.action, 0, Qt.AlignmentFlag.AlignTop)
        texts = QVBoxLayout()
        texts.setSpacing(GRID_PX // 2)
        texts.addWidget(self._headline)
        texts.addLayout(below)
        texts.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
        row.setSpacing(GRID_PX)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(texts, 1)
        self.show_verdict("empty", "")

    def show_verdict(
        self, state: State, headline: str, details: Sequence[str] = (), button: str = "", tooltip: str = ""
    ) -> None:
        """Show a sentence.

        Args:
            state: of the scan, for the mark.
            headline: the sentence.
            details: further ones.
            button: text of the button.
            tooltip: where the headline's numbers come from.
        """
        self._mark.set_state(state)
        self._headline.setText(headline)
        self._headline.setToolTip(tooltip)
        more = len(details) - _MOST_REASONS
        shown = list(details[:_MOST_REASONS])
        if more > 0:
            shown.append(self.tr("{n} more in the tooltip.").format(n=more))
        self._details.setText("\n".join(shown))
        self._details.setToolTip("\n".join(details) if more > 0 else "")
        self.action.setText(button)
        self.action.setAccessibleName(button)
