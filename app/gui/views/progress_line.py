"""How much is done, as a line that fills."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import hatch

_RADIUS_PX = 3.0


class ProgressLine(QWidget):
    """Not a QProgressBar: that repaints the window at each value, and every 3D view with it.

    Hatched as long as the amount of work is unknown.
    """

    def __init__(self) -> None:
        super().__init__()
        self._fraction: float | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    @property
    def fraction(self) -> float | None:
        """What is done, 0 to 1; none if unknown."""
        return self._fraction

    def set_fraction(self, fraction: float | None) -> None:
        """Show how much is done."""
        if fraction != self._fraction:
            self._fraction = None if fraction is None else min(max(fraction, 0.0), 1.0)
            self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(20 * GRID_PX, GRID_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = theme_of(self)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        whole = QRectF(self.rect())
        trough = QPainterPath()
        trough.addRoundedRect(whole, _RADIUS_PX, _RADIUS_PX)
        painter.fillPath(trough, theme.color("line"))
        if self._fraction is None:
            hatch(painter, trough, theme.color("accent"))
        else:
            whole.setWidth(whole.width() * self._fraction)
            painter.setBrush(theme.color("accent"))
            painter.drawRoundedRect(whole, _RADIUS_PX, _RADIUS_PX)
        painter.end()
