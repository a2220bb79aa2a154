"""A chip: a short fact in a coloured frame, such as which cell this is."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import QFontMetrics, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.state_mark import State, paint_mark

_MARK_PX = 16


class Chip(QWidget):
    """Text, filled or framed in a colour of the theme, with a state's mark before it if there is one."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self._text = ""
        self._color = "muted"
        self._is_filled = False
        self._state: State | None = None
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    @property
    def text(self) -> str:
        """What it says."""
        return self._text

    def say(
        self,
        text: str,
        *,
        color: str = "muted",
        is_filled: bool = False,
        state: State | None = None,
        tip: str = "",
    ) -> None:
        """Say something, in a colour given by its name in the theme."""
        self._text, self._color, self._is_filled, self._state = text, color, is_filled, state
        self.setAccessibleName(text)
        self.setToolTip(tip)
        self.updateGeometry()
        self.update()

    @override
    def sizeHint(self) -> QSize:
        metrics = QFontMetrics(self.font())
        mark = _MARK_PX + GRID_PX // 2 if self._state is not None else 0
        width = metrics.horizontalAdvance(self._text) + (3 * GRID_PX if self._is_filled else GRID_PX) + mark
        return QSize(width, metrics.height() + GRID_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = theme_of(self)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        area = self.rect()
        painter.setPen(theme.color("text"))
        if self._is_filled:
            painter.setBrush(theme.color(self._color))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.drawRoundedRect(area.adjusted(1, 1, -1, -1), 6, 6)
            painter.setPen(QPen(theme.color("window" if theme.is_dark else "surface")))
        left = GRID_PX // 2 if not self._is_filled else 0
        if self._state is not None:
            mark = area.adjusted(left, 0, 0, 0)
            mark.setWidth(_MARK_PX)
            paint_mark(painter, mark.toRectF(), self._state, theme)
            left += _MARK_PX + GRID_PX // 2
        where = Qt.AlignmentFlag.AlignCenter if self._is_filled else Qt.AlignmentFlag.AlignVCenter
        painter.drawText(area.adjusted(left, 0, 0, 0), where, self._text)
        painter.end()

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
