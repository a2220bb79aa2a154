"""A score in the table of objects: its number above a bar that shows it beside the threshold."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPalette
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget
from typing_extensions import override

from app.gui.pages.tuning.object_pictures import PICTURE_PX
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import tabular

CELL_ROLE = Qt.ItemDataRole.UserRole
_BAR_PX, _BELOW_PX, _ROW_GAP_PX = 5, 11, 4


@dataclass(frozen=True)
class ScoreCell:
    """What a cell shows.

    Attributes:
        score: capacity share or Omega; none if the object was not judged, or could not be.
        threshold: above which the object is a container.
        is_right: whether it agrees with the label; none if that cannot be said.
        word: what is said beside the number, such as "wrong"; may be empty.
        is_flipped: whether the verdict differs from the column before.
    """

    score: float | None
    threshold: float
    is_right: bool | None
    word: str = ""
    is_flipped: bool = False

    @property
    def text(self) -> str:
        """The number with what is said of it."""
        number = "--" if self.score is None else f"{self.score:.3f}"
        return "   ".join(filter(None, (number, self.word, "⇄" if self.is_flipped else "")))


class ScoreDelegate(QStyledItemDelegate):
    """Draws a bar with the threshold under the text of the cells that hold a `ScoreCell`."""

    def __init__(self, view: QWidget) -> None:
        super().__init__(view)
        self._view = view

    @override
    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:
        hint = super().sizeHint(option, index)
        return QSize(
            hint.width(),
            max(hint.height(), PICTURE_PX[1] + _ROW_GAP_PX if index.parent().isValid() else 4 * GRID_PX),
        )

    @override
    def initStyleOption(
        self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        super().initStyleOption(option, index)
        cell = index.data(CELL_ROLE)
        if isinstance(cell, ScoreCell) and cell.is_right is False:
            option.font = tabular(option.font, bold=True)
            option.palette.setColor(QPalette.ColorRole.Text, theme_of(self._view).color("attention"))

    @override
    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        super().paint(painter, option, index)
        cell = index.data(CELL_ROLE)
        if not isinstance(cell, ScoreCell) or cell.score is None:
            return
        theme = theme_of(self._view)
        is_selected = bool(option.state & QStyle.StateFlag.State_Selected)
        box = QRectF(option.rect).adjusted(GRID_PX / 2, 0, -GRID_PX, 0)
        bar = QRectF(box.left(), box.center().y() + _BELOW_PX, box.width(), _BAR_PX)
        painter.fillRect(bar, theme.color("muted" if is_selected else "raised"))
        filled = QRectF(bar)
        filled.setWidth(bar.width() * min(max(cell.score, 0.0), 1.0))
        painter.fillRect(filled, theme.color("on_accent" if is_selected else "accent"))
        threshold = bar.left() + bar.width() * min(max(cell.threshold, 0.0), 1.0)
        mark = QRectF(threshold - 1, bar.top() - 2, 2, bar.height() + 4)
        painter.fillRect(mark, theme.color("on_accent" if is_selected else "text"))
