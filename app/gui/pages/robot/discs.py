"""The mark of a step: its number in a ring, filled while it is the next one, a tick when it is done."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QFont, QPainter, QPen

from app.gui.theme import Theme
from app.gui.views.painting import tabular

DiscState = Literal["to come", "next", "done"]
_TICK = (QPointF(-4.5, 0.5), QPointF(-1.5, 3.5), QPointF(4.5, -3.5))


def state_of(number: int, current: int) -> DiscState:
    """How a step stands when another one is current."""
    if number == current:
        return "next"
    return "done" if number < current else "to come"


def paint_disc(
    painter: QPainter, box: QRectF, number: int, state: DiscState, theme: Theme, font: QFont
) -> None:
    """Paint the mark into a square."""
    painter.setPen(QPen(theme.color("line" if state == "to come" else "accent"), 2))
    painter.setBrush(theme.color("accent" if state == "next" else "surface"))
    painter.drawEllipse(box.adjusted(1.5, 1.5, -1.5, -1.5))
    if state == "done":
        painter.setPen(QPen(theme.color("accent"), 2.2, c=Qt.PenCapStyle.RoundCap))
        painter.drawPolyline([box.center() + point for point in _TICK])
        return
    painter.setPen(theme.color("on_accent" if state == "next" else "muted"))
    painter.setFont(tabular(font, bold=state == "next"))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(number))
