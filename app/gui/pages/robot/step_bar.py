"""Numbered steps: the mark of one, and the row from connecting to the outcome."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, Theme, theme_of
from app.gui.views.painting import smaller, tabular

DiscState = Literal["to come", "next", "done"]
_TICK = (QPointF(-4.5, 0.5), QPointF(-1.5, 3.5), QPointF(4.5, -3.5))
_IN_BAR_PX, _ALONE_PX = 22, 24


def state_of(number: int, current: int) -> DiscState:
    """Return the state of a step when another one is current."""
    if number == current:
        return "next"
    return "done" if number < current else "to come"


def _paint_disc(
    painter: QPainter, box: QRectF, number: int, state: DiscState, theme: Theme, font: QFont
) -> None:
    """Paint a step's number in a ring: filled while it is the next one, a tick when it is done."""
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


class _Painted(QWidget):
    """Is painted anew with other colours."""

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()


class Disc(_Painted):
    """The mark of one step."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number
        self._state: DiscState = "to come"
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def set_state(self, state: DiscState) -> None:
        """Show another state."""
        self._state = state
        self.setAccessibleName(self.tr("done") if state == "done" else str(self.number))
        self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(_ALONE_PX, _ALONE_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        _paint_disc(painter, QRectF(self.rect()), self.number, self._state, theme_of(self), self.font())
        painter.end()


class StepBar(_Painted):
    """Marks with words, joined by a line."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("step_bar")
        self._names = (
            self.tr("Connect"),
            self.tr("Plan"),
            self.tr("Check"),
            self.tr("Pour"),
            self.tr("Outcome"),
        )
        self._current = 0
        self.set_current(0)

    def set_current(self, number: int) -> None:
        """Show another step as the current one, counted from 1; 0: none is."""
        self._current = number
        said = self.tr("No step yet")
        if number:
            said = self.tr("Step {k} of {n}: {name}").format(
                k=number, n=len(self._names), name=self._names[number - 1]
            )
        self.setAccessibleName(said)
        self.setToolTip(said)
        self.update()

    @override
    def sizeHint(self) -> QSize:
        height = _IN_BAR_PX + GRID_PX // 2 + round(QFontMetricsF(smaller(self.font())).height())
        return QSize(300, height)

    @override
    def minimumSizeHint(self) -> QSize:
        return QSize(240, self.sizeHint().height())

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        cell = self.width() / len(self._names)
        y = _IN_BAR_PX / 2 + 1
        painter.setPen(QPen(theme_of(self).color("line"), 2))
        painter.drawLine(QPointF(cell / 2, y), QPointF(self.width() - cell / 2, y))
        for k, name in enumerate(self._names):
            self._paint_step(painter, k + 1, name, QRectF(k * cell, 0, cell, self.height()), y)
        painter.end()

    def _paint_step(self, painter: QPainter, number: int, name: str, box: QRectF, y: float) -> None:
        theme = theme_of(self)
        state = state_of(number, self._current)
        disc = QRectF(0, 0, _IN_BAR_PX, _IN_BAR_PX)
        disc.moveCenter(QPointF(box.center().x(), y))
        _paint_disc(painter, disc, number, state, theme, self.font())
        font = smaller(self.font())
        font.setBold(state == "next")
        painter.setFont(font)
        painter.setPen(theme.color("text" if state == "next" else "muted"))
        words = QRectF(box.left(), disc.bottom() + 2, box.width(), box.bottom() - disc.bottom())
        painter.drawText(words, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop, name)
