"""How a thumbnail is painted: picture, label, and its state as a shape and a word."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from app.gui.theme import Theme, theme_of
from app.gui.views.painting import tabular

_COLORS = {"pending": "muted", "taken": "good", "poor": "attention", "failed": "failed"}
_MARK_PX = 9.0
_GAP_PX = 1.5


def paint_view_mark(painter: QPainter, box: QRectF, state: str, theme: Theme) -> None:
    """Paint a view's state: a hollow ring, a full disc, a triangle, a cross."""
    color = theme.color(_COLORS[state])
    side = min(box.width(), box.height()) * 0.8
    center = box.center()
    half = side / 2
    painter.save()
    painter.setPen(QPen(color, 1.8, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    if state == "taken":
        painter.setBrush(color)
    if state in ("pending", "taken"):
        painter.drawEllipse(center, half - 0.9, half - 0.9)
    elif state == "poor":
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        corners = [QPointF(0, -half), QPointF(half * 1.1, half * 0.8), QPointF(-half * 1.1, half * 0.8)]
        painter.drawPolygon(QPolygonF([center + corner for corner in corners]))
    else:
        for sign in (-1, 1):
            reach = QPointF(half * 0.75, sign * half * 0.75)
            painter.drawLine(center - reach, center + reach)
    painter.restore()


class ThumbnailDelegate(QStyledItemDelegate):
    """Paints cells of one size; `size` is set by the grid."""

    def __init__(self, view: QWidget) -> None:
        super().__init__(view)
        self._view = view
        self.size = QSize(64, 64)

    def cell_size(self, width_px: int) -> QSize:
        """Return the size of a cell of a width: a 4:3 picture and a line for the state."""
        return QSize(width_px, round((width_px - 4) * 3 / 4 + self._line_px() + 6))

    def _font(self) -> QFont:
        return tabular(self._view.font(), 8.0)

    def _line_px(self) -> float:
        return QFontMetricsF(self._font()).height()

    def sizeHint(self, _option: QStyleOptionViewItem, _index: QModelIndex | QPersistentModelIndex) -> QSize:
        """Return the grid's cell."""
        return self.size

    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        """Paint one view."""
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        theme = theme_of(self._view)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        box = QRectF(rect).adjusted(2, 2, -2, -2)
        line = self._line_px()
        frame = QRectF(box.left(), box.top(), box.width(), box.height() - line - _GAP_PX)
        self._paint_picture(painter, frame, index.data(Qt.ItemDataRole.DecorationRole))
        painter.setFont(self._font())
        self._paint_label(painter, frame, str(index.data()))
        view_state = str(index.data(Qt.ItemDataRole.UserRole))
        self._paint_state(painter, QRectF(box.left(), box.bottom() - line, box.width(), line), view_state)
        if state & QStyle.StateFlag.State_Selected:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(theme.color("accent"), 3))
            painter.drawRoundedRect(QRectF(rect).adjusted(1.5, 1.5, -1.5, -1.5), 4, 4)
        painter.restore()

    def _paint_picture(self, painter: QPainter, frame: QRectF, pixmap: Any) -> None:
        theme = theme_of(self._view)
        if isinstance(pixmap, QPixmap) and not pixmap.isNull():
            size = pixmap.size().scaled(frame.size().toSize(), Qt.AspectRatioMode.KeepAspectRatioByExpanding)
            shown = QRectF(0, 0, size.width(), size.height())
            shown.moveCenter(frame.center())
            painter.save()
            painter.setClipRect(frame)
            painter.drawPixmap(shown, pixmap, QRectF(pixmap.rect()))
            painter.restore()
        else:
            painter.setPen(QPen(theme.color("line"), 1, Qt.PenStyle.DashLine))
            painter.setBrush(theme.color("surface"))
            painter.drawRoundedRect(frame.adjusted(0.5, 0.5, -0.5, -0.5), 3, 3)

    def _paint_label(self, painter: QPainter, frame: QRectF, label: str) -> None:
        theme = theme_of(self._view)
        metrics = QFontMetricsF(painter.font())
        plate = QRectF(frame.left(), frame.top(), metrics.horizontalAdvance(label) + 6, metrics.height())
        path = QPainterPath()
        path.addRoundedRect(plate, 3, 3)
        back = QColor(theme.color("window"))
        back.setAlphaF(0.8)
        painter.fillPath(path, back)
        painter.setPen(theme.color("text"))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, label)

    def _paint_state(self, painter: QPainter, box: QRectF, state: str) -> None:
        theme = theme_of(self._view)
        words = {
            "pending": self.tr("pending"),
            "taken": self.tr("taken"),
            "poor": self.tr("poor"),
            "failed": self.tr("failed"),
        }
        word = words[state]
        width = _MARK_PX + _GAP_PX + QFontMetricsF(painter.font()).horizontalAdvance(word)
        left = max(box.center().x() - width / 2, box.left())
        mark = QRectF(left, box.center().y() - _MARK_PX / 2, _MARK_PX, _MARK_PX)
        paint_view_mark(painter, mark, state, theme)
        painter.setPen(theme.color("text" if state != "pending" else "muted"))
        beside = QRectF(mark.right() + _GAP_PX, box.top(), box.right() - mark.right() - 2, box.height())
        painter.drawText(beside, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, word)
