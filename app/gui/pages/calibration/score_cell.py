"""How one score is painted in the table: the number, a word where to look, a bar with the threshold."""

from __future__ import annotations

from dataclasses import dataclass, replace

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QPainter, QPen
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, Theme, theme_of
from app.gui.views.health_table import paint_attention
from app.gui.views.painting import smaller, tabular

CELL_ROLE = Qt.ItemDataRole.UserRole
_MARK_PX = 16
_BAR_PX = 5


@dataclass(frozen=True)
class ScoreCell:
    """What a cell tells.

    Attributes:
        score: capacity share or Omega; none if the object was not judged, or could not be.
        threshold: above which the object is a container.
        is_right: whether it agrees with the label; none if there is no telling.
        word: what is said beside the bar, such as "wrong"; may be empty.
        is_flipped: whether the verdict differs from the column before.
    """

    score: float | None
    threshold: float
    is_right: bool | None
    word: str = ""
    is_flipped: bool = False


class ScoreDelegate(QStyledItemDelegate):
    """Paints the cells that hold an `ScoreCell`; the others as usual."""

    def __init__(self, view: QWidget) -> None:
        super().__init__(view)
        self._view = view

    @override
    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:
        hint = super().sizeHint(option, index)
        return QSize(hint.width(), max(hint.height(), 4 * GRID_PX))

    @override
    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        super().paint(painter, option, index)
        cell = index.data(CELL_ROLE)
        if not isinstance(cell, ScoreCell):
            return
        rect: QRect = option.rect
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self._view)
        if (
            option.state & QStyle.StateFlag.State_Selected
        ):  # everything in the one colour that is read on accent
            ink = theme.on_accent
            theme = replace(theme, text=ink, muted=ink, attention=ink, raised=theme.muted, accent=ink)
        _paint(painter, QRectF(rect).adjusted(GRID_PX, 0, -GRID_PX, 0), cell, self._view.font(), theme)
        painter.restore()


def _paint(painter: QPainter, box: QRectF, cell: ScoreCell, font: QFont, theme: Theme) -> None:
    """The number and what to say of it, above the bar."""
    middle = Qt.AlignmentFlag.AlignVCenter
    line = box.adjusted(0, 2, 0, -_BAR_PX - 6)
    painter.setFont(tabular(font, bold=cell.is_right is False))
    painter.setPen(theme.color("text" if cell.score is not None else "muted"))
    painter.drawText(line, middle, "--" if cell.score is None else f"{cell.score:.3f}")
    painter.setFont(smaller(font))
    word_px = QFontMetricsF(painter.font()).horizontalAdvance(cell.word)
    flip = QRectF(line.right() - _MARK_PX, line.top(), _MARK_PX, line.height())
    words = QRectF(flip.left() - word_px - 4, line.top(), word_px + 2, line.height())
    if cell.word:
        painter.setPen(theme.color("attention"))
        painter.drawText(words, middle, cell.word)
    if cell.is_right is False:
        paint_attention(
            painter, QRectF(words.left() - _MARK_PX - 2, line.top(), _MARK_PX, line.height()), theme
        )
    if cell.is_flipped:
        _paint_flip(painter, flip, theme)
    if cell.score is not None:
        bar = QRectF(box.left(), box.bottom() - _BAR_PX - 5, box.width(), _BAR_PX)
        _paint_bar(painter, bar, cell.score, cell.threshold, theme)


def _paint_flip(painter: QPainter, box: QRectF, theme: Theme) -> None:
    """Two arrows, one each way."""
    painter.setPen(QPen(theme.color("text"), 1.5))
    center = box.center()
    for up, side in ((-2.5, 1.0), (2.5, -1.0)):
        tip, tail = center + QPointF(5 * side, up), center + QPointF(-5 * side, up)
        painter.drawLine(tail, tip)
        painter.drawLine(tip, tip + QPointF(-3 * side, up * 0.9))


def _paint_bar(painter: QPainter, bar: QRectF, score: float, threshold: float, theme: Theme) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(theme.color("raised"))
    painter.drawRoundedRect(bar, 2, 2)
    filled = QRectF(bar)
    filled.setWidth(bar.width() * min(max(score, 0.0), 1.0))
    painter.setBrush(theme.color("accent"))
    painter.drawRoundedRect(filled, 2, 2)
    x = bar.left() + bar.width() * min(max(threshold, 0.0), 1.0)
    painter.setPen(QPen(theme.color("text"), 2))
    painter.drawLine(QPointF(x, bar.top() - 1), QPointF(x, bar.bottom() + 3))
