"""Where one is on the way from connecting to the outcome."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget
from typing_extensions import override

from app.gui.pages.robot.discs import paint_disc, state_of
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller

_DISC_PX = 22


class StepBar(QWidget):
    """Numbered discs with words: done ones have a tick, the current one is filled."""

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

    @property
    def current(self) -> int:
        """The number of the step, from 1; 0 if none is current."""
        return self._current

    def set_current(self, number: int) -> None:
        """Show another step as the current one."""
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
        height = _DISC_PX + GRID_PX // 2 + round(QFontMetricsF(smaller(self.font())).height())
        return QSize(300, height)

    @override
    def minimumSizeHint(self) -> QSize:
        return QSize(240, self.sizeHint().height())

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self)
        cell = self.width() / len(self._names)
        y = _DISC_PX / 2 + 1
        painter.setPen(QPen(theme.color("line"), 2))
        painter.drawLine(QPointF(cell / 2, y), QPointF(self.width() - cell / 2, y))
        for k, name in enumerate(self._names):
            self._paint_step(painter, k + 1, name, QRectF(k * cell, 0, cell, self.height()), y)
        painter.end()

    def _paint_step(self, painter: QPainter, number: int, name: str, box: QRectF, y: float) -> None:
        theme = theme_of(self)
        state = state_of(number, self._current)
        disc = QRectF(0, 0, _DISC_PX, _DISC_PX)
        disc.moveCenter(QPointF(box.center().x(), y))
        paint_disc(painter, disc, number, state, theme, self.font())
        font = smaller(self.font())
        font.setBold(state == "next")
        painter.setFont(font)
        painter.setPen(theme.color("text" if state == "next" else "muted"))
        words = QRectF(box.left(), disc.bottom() + 2, box.width(), box.bottom() - disc.bottom())
        painter.drawText(words, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop, name)
