"""What the pyramids in a 3D view mean."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller

FrustumState = Literal["pending", "taken", "poor", "failed"]
_COLORS: dict[FrustumState, str] = {
    "pending": "muted",
    "taken": "good",
    "poor": "attention",
    "failed": "failed",
}
"""Those of the pyramids."""
_MARK_PX = 14.0
_OPACITY = 0.55


class FrustumLegend(QWidget):
    """A line for each state that occurs: its pyramid, as it is drawn, and the word for it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("frustum_legend")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.states: tuple[FrustumState, ...] = ()
        self.hide()

    def show_states(self, states: Iterable[FrustumState]) -> None:
        """Explain these states; none: nothing."""
        occurring = set(states)
        self.states = tuple(state for state in _COLORS if state in occurring)
        self.setVisible(bool(self.states))
        self.setAccessibleName(", ".join(self._words(state) for state in self.states))
        self.resize(self.sizeHint())
        self.update()

    def _words(self, state: FrustumState) -> str:
        words = {
            "pending": self.tr("view to come"),
            "taken": self.tr("view taken"),
            "poor": self.tr("poor view"),
            "failed": self.tr("view failed"),
        }
        return words[state]

    @override
    def sizeHint(self) -> QSize:
        metrics = QFontMetricsF(smaller(self.font()))
        widest = max((metrics.horizontalAdvance(self._words(state)) for state in self.states), default=0.0)
        width = _MARK_PX + widest + 3 * GRID_PX
        return QSize(round(width), round(len(self.states) * self._line_px(metrics) + GRID_PX))

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = theme_of(self)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(smaller(self.font()))
        plate = theme.color("surface")
        plate.setAlphaF(0.85)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(plate)
        painter.drawRoundedRect(QRectF(self.rect()), 4, 4)
        line_px = self._line_px(QFontMetricsF(painter.font()))
        for row, state in enumerate(self.states):
            box = QRectF(GRID_PX, GRID_PX / 2 + row * line_px, _MARK_PX, line_px)
            _paint_pyramid(painter, box, state, theme.color(_COLORS[state]))
            painter.setPen(theme.color("text"))
            text = QRectF(box.right() + GRID_PX, box.top(), self.width() - box.right() - GRID_PX, line_px)
            painter.drawText(text, Qt.AlignmentFlag.AlignVCenter, self._words(state))
        painter.end()

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()

    def _line_px(self, metrics: QFontMetricsF) -> float:
        return max(metrics.height(), _MARK_PX) + 2


def _paint_pyramid(painter: QPainter, box: QRectF, state: FrustumState, color: QColor) -> None:
    """A pyramid from the side, apex at the left, with the mark of its state on its base."""
    middle, half = box.center(), _MARK_PX / 2
    apex = QPointF(box.left(), middle.y())
    high, low = QPointF(box.right(), middle.y() - half + 2), QPointF(box.right(), middle.y() + half - 2)
    fill = QColor(color)
    fill.setAlphaF(_OPACITY if state in ("taken", "poor") else 0.0)
    painter.setBrush(fill)
    painter.setPen(QPen(color, 1.5))
    painter.drawPolygon(QPolygonF([apex, high, low]))
    if state == "poor":
        painter.drawLine(QPointF(middle.x(), middle.y()), QPointF(box.right(), middle.y()))
    elif state == "failed":
        painter.drawLine(QPointF(middle.x(), high.y()), QPointF(box.right(), low.y()))
        painter.drawLine(QPointF(middle.x(), low.y()), QPointF(box.right(), high.y()))
