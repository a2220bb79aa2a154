"""The mark of a stage's state: each has its own shape, so that nobody depends on its colour."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import QCoreApplication, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from app.gui.theme import Theme, theme_of

State = Literal["empty", "running", "fresh", "stale", "failed"]
STATES: tuple[State, ...] = ("empty", "running", "fresh", "stale", "failed")
_COLORS: dict[State, str] = {
    "empty": "muted",
    "running": "accent",
    "fresh": "good",
    "stale": "attention",
    "failed": "failed",
}
MARK_PX = 16


def state_word(state: State) -> str:
    """Return the word shown beside the mark, in the user's language."""
    words = {
        "empty": QCoreApplication.translate("StateMark", "empty"),
        "running": QCoreApplication.translate("StateMark", "running"),
        "fresh": QCoreApplication.translate("StateMark", "fresh"),
        "stale": QCoreApplication.translate("StateMark", "stale"),
        "failed": QCoreApplication.translate("StateMark", "failed"),
    }
    return words[state]


def paint_mark(painter: QPainter, rect: QRectF, state: State, theme: Theme) -> None:
    """Paint a state centred in `rect`.

    Empty is a hollow ring, running three quarters of a ring with its head, fresh a full disc, stale a ring
    half filled, failed a cross.
    """
    side = min(rect.width(), rect.height()) * 0.78
    width = max(side * 0.15, 1.5)
    box = QRectF(0, 0, side - width, side - width)
    box.moveCenter(rect.center())
    color = theme.color(_COLORS[state])
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(color, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    if state == "running":
        painter.drawArc(box, 0, 270 * 16)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        head = QPointF(box.right(), box.center().y())
        painter.drawEllipse(head, width * 1.15, width * 1.15)
    elif state == "failed":
        inset = box.adjusted(width * 0.4, width * 0.4, -width * 0.4, -width * 0.4)
        painter.drawLine(inset.topLeft(), inset.bottomRight())
        painter.drawLine(inset.topRight(), inset.bottomLeft())
    else:
        if state == "fresh":
            painter.setBrush(color)
        painter.drawEllipse(box)
        if state == "stale":
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(color)
            painter.drawPie(box, 90 * 16, 180 * 16)
    painter.restore()


class StateMark(QWidget):
    """A stage's state as a small painted mark; the word is its tooltip and accessible name."""

    def __init__(self, state: State = "empty", parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("state_mark")
        self._state: State = state
        self.setFixedSize(MARK_PX, MARK_PX)
        self._update_texts()

    @property
    def state(self) -> State:
        """What is shown."""
        return self._state

    def set_state(self, state: State) -> None:
        """Show another state."""
        self._state = state
        self._update_texts()
        self.update()

    def _update_texts(self) -> None:
        self.setToolTip(state_word(self._state))
        self.setAccessibleName(state_word(self._state))

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(MARK_PX, MARK_PX)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the mark."""
        painter = QPainter(self)
        paint_mark(painter, QRectF(self.rect()), self._state, theme_of(self))
        painter.end()
