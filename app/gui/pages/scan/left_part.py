"""The left of the Scan page: the cell in 3D, the verdict, and the views in small."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtGui import QResizeEvent, QShowEvent
from PySide6.QtWidgets import QListView, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.page import SplitView
from app.gui.pages.scan.verdict_part import VerdictPart
from app.gui.pages.scan.view_part import ScanView
from app.gui.theme import GRID_PX
from app.gui.views.thumbnails import ThumbnailGrid

_CELL_PX = (58, 63)
"""Of a thumbnail at its smallest, with the line for its state."""
_SHARE = 0.2
"""Of the height, for the thumbnails, if they do not need more."""
_SIDE_PX, _SIDE_SHARE = 320, 0.25
"""Width of what is at the right: at least, and of the page's."""


class ScanLeft(QWidget):
    """All that is looked at.

    The thumbnails lie below the view, not in the side panel as first sketched: there they would leave no room
    for the camera's images in a window of 1280 x 800.

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
        self.verdict = VerdictPart()
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
        self.grid.selected.connect(self._pick)

    def make_room(self) -> None:
        """Give the thumbnails as many rows as they need, after their number has changed."""
        n = len(self.grid.items)
        self.grid.setVisible(n > 0)
        if n:
            columns = max((self.width() - GRID_PX) // _CELL_PX[0], 1)
            needed = -(-n // columns) * _CELL_PX[1]
            self.grid.setFixedHeight(round(max(min(needed, self.height() / 3), _SHARE * self.height())))

    def _pick(self, index: int) -> None:
        """A list that gets the focus calls its first entry the current one; that is nobody's choice."""
        entries = self.grid.findChild(QListView)
        if entries is not None and entries.selectionModel().isSelected(entries.model().index(index, 0)):
            self.view_picked.emit(index)

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.make_room()


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
