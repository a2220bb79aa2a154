"""The left of the Cell page: the cell in 3D with the board, what the camera sees, and what goes on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QStackedWidget, QVBoxLayout, QWidget

from app.gui.pages.cell_model import ShownCell
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.depth_image import DepthPanel, ImagePanel
from app.gui.views.labels import text_label
from app.gui.views.scene import Frustum, Scene3D
from app.gui.views.scene.shapes import Shape, box_mesh
from app.gui.views.state_mark import State, StateMark
from core.calibration.board import BoardSpec
from core.geometry import FloatArray, make_pose, rotation_z, transform_points

_ARM, _BOX, _BOARD, _INK, _VIEWS = "arm", "box", "board", "board ink", "views"
_REACH, _TABLE, _CUP = "reach", "table", "cup"
_THICKNESS_M, _INK_M = 0.003, 0.0012
"""Of the sheet, and how far its ink is drawn above it, so that the two do not flicker."""
_PICTURE_PX = (256, 192)
_DOT_PX = 2


class CellView(QWidget):
    """All that is looked at.

    Signals: `box_edited` with lower and upper corner (3,) of the crop box, when a side of it was dragged.

    Attributes:
        scene: the 3D view.
        now: below it.
    """

    box_edited = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self.scene = Scene3D()
        self.scene.setObjectName("cell_3d")
        self.scene.setAccessibleName(self.tr("The cell in 3D"))
        self.scene.set_empty_text(self.tr("Reading the cell file …"))
        self.now = NowPanel()
        self._cell: ShownCell | None = None
        self._board = BoardSpec()
        self._has_handles = False
        self.scene.box_edited.connect(lambda _, low_m, high_m: self.box_edited.emit(low_m, high_m))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        self._live = LivePanel()
        self._large = QStackedWidget()
        self._large.addWidget(self.scene)
        self._large.addWidget(self._live)
        column.addWidget(self._large, 1)
        column.addWidget(self.now)

    def show_cell(self, cell: ShownCell, board: BoardSpec) -> None:
        """Show another cell, its arm at rest, and the board that is used in it."""
        is_other = self._cell is None or self._cell.model.home_rad.tolist() != cell.model.home_rad.tolist()
        self._cell, self._board = cell, board
        scene, model = self.scene, cell.model
        model.draw_furniture(scene)
        model.draw_platform_top(scene, np.empty((0, 3), dtype=np.float32))
        if cell.has_arm:
            scene.set_mesh(_CUP, *model.cup, color="accent")
        self._draw_box(cell)
        if cell.has_arm and (is_other or _ARM not in scene.layers()):
            scene.set_arm(_ARM, model.arm, model.home_rad, tools=model.tools)
            scene.set_points(_REACH, cell.reach_m, color="scene", size_px=1)
        if is_other:
            scene.fit(_TABLE, _BOX, _REACH)

    def show_live(self, color: npt.NDArray[np.uint8], depth_m: npt.NDArray[np.float32]) -> None:
        """Show what the camera sees, in place of the cell."""
        self._large.setCurrentWidget(self._live)
        self.now.show_frame(False)
        self._live.show_images(color, depth_m)

    def end_live(self) -> None:
        """Show the cell again."""
        self._large.setCurrentWidget(self.scene)
        self.now.show_frame(True)

    def offer_box(self, is_offered: bool) -> None:
        """Let the sides of the crop box be dragged, or not."""
        if is_offered != self._has_handles:
            self._has_handles = is_offered
            if self._cell is not None:
                self._draw_box(self._cell)

    def _draw_box(self, cell: ShownCell) -> None:
        self.scene.set_box(_BOX, cell.box_min_m, cell.box_max_m, has_handles=self._has_handles)

    def show_looks(self, frusta: Sequence[Frustum], T_base_board: FloatArray | None) -> None:
        """Show from where the board was looked at, and where it lies (4, 4).

        It is drawn flat on what is below it: before the calibration it seems to be somewhere in the air, or
        inside the platform.
        """
        self.scene.set_frusta(_VIEWS, frusta)
        T_base_board = self._on_ground(T_base_board)
        if T_base_board is None:
            self.scene.remove(_BOARD)
            self.scene.remove(_INK)
            return
        paper, ink = _board_meshes(self._board)
        self.scene.set_mesh(_BOARD, *paper, color="#f4f4f0", T_world=T_base_board)
        self.scene.set_mesh(_INK, *ink, color="#2a2d33", T_world=T_base_board)

    def _on_ground(self, T_base_board: FloatArray | None) -> FloatArray | None:
        if self._cell is None or T_base_board is None:
            return None
        middle = transform_points(T_base_board, self._board.center_m)
        platform = self._cell.model.platform[0]
        low, high = platform.min(axis=0), platform.max(axis=0)
        is_on_platform = bool(((middle[:2] >= low[:2]) & (middle[:2] <= high[:2])).all())
        height_m = high[2] if is_on_platform else self._cell.model.table[0][:, 2].max()
        yaw_rad = float(np.arctan2(T_base_board[1, 0], T_base_board[0, 0]))
        turn = rotation_z(yaw_rad) @ np.diag([1.0, -1.0, -1.0])
        ground = np.array([*middle[:2], height_m + _THICKNESS_M])
        return make_pose(turn, ground - turn @ self._board.center_m)

    def bend(self, joints_rad: npt.ArrayLike | None) -> None:
        """Show the arm at joint angles (6,); none: at rest."""
        cell = self._cell
        if cell is not None and cell.has_arm:
            self.scene.set_joints(_ARM, cell.model.home_rad if joints_rad is None else joints_rad)


class LivePanel(QWidget):
    """What the camera sees now: colour, and depth with its scale, beside each other."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("live_view")
        self._color, self._depth = ImagePanel(is_above_depth=True), DepthPanel()
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._color, 1)
        row.addWidget(self._depth, 1)

    def show_images(self, color: npt.NDArray[np.uint8], depth_m: npt.NDArray[np.float32]) -> None:
        """Show colour (H, W, 3) and depth (H, W)."""
        self._color.set_image(color)
        self._depth.set_depth(depth_m)


class NowPanel(QWidget):
    """What goes on, or is next: a picture of the camera's, a mark, a sentence, and further ones."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("now")
        self._image = ImagePanel()
        self._image.setFixedSize(*_PICTURE_PX)
        self._image.set_empty_text(self.tr("What the camera sees appears here."))
        self._mark = StateMark("empty")
        self._headline = text_label("headline", "verdict")
        self._details = text_label("details")
        texts = QVBoxLayout()
        texts.setSpacing(GRID_PX)
        texts.addWidget(self._headline)
        texts.addWidget(self._details)
        texts.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
        row.setSpacing(GRID_PX)
        row.addWidget(self._image)
        row.addSpacing(GRID_PX)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(texts, 1)

    def say(self, state: State, headline: str, details: Sequence[str] = ()) -> None:
        """Show sentences."""
        self._mark.set_state(state)
        self._headline.setText(headline)
        self._details.setText("\n".join(details))

    def show_frame(self, is_shown: bool) -> None:
        """Show the picture's place, or leave it out."""
        self._image.setVisible(is_shown)

    def show_picture(self, color: npt.NDArray[np.uint8] | None, corners_px: FloatArray | None = None) -> None:
        """Show an image (H, W, 3), and the corners (C, 2) that were found in it."""
        if color is None:
            self._image.set_image(None)
            return
        marked = color.copy()
        accent = theme_of(self).color("accent")
        dot = (accent.red(), accent.green(), accent.blue())
        for column, row in np.round(np.empty((0, 2)) if corners_px is None else corners_px).astype(int):
            top, left = max(row - _DOT_PX, 0), max(column - _DOT_PX, 0)
            marked[top : row + _DOT_PX + 1, left : column + _DOT_PX + 1] = dot
        self._image.set_image(marked)


def _board_meshes(board: BoardSpec) -> tuple[Shape, Shape]:
    """The sheet, and its black squares, in the board's frame, whose z points into the table."""
    width_m, height_m = board.size_m
    paper = box_mesh((0.0, 0.0, 0.0), (width_m, height_m, _THICKNESS_M))
    squares = [(c, r) for r in range(board.rows) for c in range(board.columns) if (r + c) % 2 == 0]
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    flat = np.concatenate([(corners + square) * board.square_m for square in squares])
    vertices = np.column_stack([flat, np.full(len(flat), -_INK_M)])
    first = 4 * np.arange(len(squares))[:, None]
    faces = np.concatenate([first + np.array(triangle) for triangle in ([0, 1, 2], [0, 2, 3])])
    return paper, (vertices, faces)
