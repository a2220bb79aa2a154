"""The strip of a time line: named sections, and a play head to drag."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QFontMetricsF,
    QHelpEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller

_HEAD_PX = 8
_LEAST_LETTERS = 6
"""A name is shortened to no fewer; fewer tell nobody anything."""


@dataclass(frozen=True)
class Section:
    """A named stretch of time."""

    name: str
    begin_s: float
    end_s: float


class Scrubber(QWidget):
    """Sections side by side in proportion to their time, and the play head.

    Attributes:
        scrubbed: the time in s to which the user dragged or clicked.
    """

    scrubbed = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("timeline_scrubber")
        self.setAccessibleName(self.tr("Time line"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._duration_s = 0.0
        self._time_s = 0.0
        self._sections: tuple[Section, ...] = ()

    def set_sections(self, duration_s: float, sections: Sequence[Section]) -> None:
        """Show other sections of a whole of `duration_s`."""
        self._duration_s = duration_s
        self._sections = tuple(sections)
        self._time_s = 0.0
        self.update()

    def set_time(self, time_s: float) -> None:
        """Move the play head, without a signal."""
        self._time_s = time_s
        self.update()

    def section_at(self, time_s: float) -> Section | None:
        """Return the section that holds a time."""
        return next(
            (section for section in self._sections if section.begin_s <= time_s < section.end_s), None
        )

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(320, round(QFontMetricsF(smaller(self.font())).height()) + _HEAD_PX + GRID_PX)

    def minimumSizeHint(self) -> QSize:
        """Return the least size it can be read at."""
        return QSize(120, self.sizeHint().height())

    def _track(self) -> QRectF:
        return QRectF(self.rect()).adjusted(_HEAD_PX, _HEAD_PX, -_HEAD_PX, -2)

    def _x_of(self, time_s: float) -> float:
        track = self._track()
        return track.left() + track.width() * (time_s / self._duration_s if self._duration_s else 0.0)

    def _time_at(self, x: float) -> float:
        track = self._track()
        ratio = (x - track.left()) / max(track.width(), 1.0)
        return min(max(ratio, 0.0), 1.0) * self._duration_s

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Go to the time under the mouse."""
        if event.button() == Qt.MouseButton.LeftButton and self._duration_s > 0:
            self.scrubbed.emit(self._time_at(event.position().x()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the play head."""
        if event.buttons() & Qt.MouseButton.LeftButton and self._duration_s > 0:
            self.scrubbed.emit(self._time_at(event.position().x()))

    def event(self, event: QEvent) -> bool:
        """Tell the section under the mouse."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            section = self.section_at(self._time_at(event.pos().x()))
            text = ""
            if section is not None:
                text = self.tr("{name}: {begin:.2f} to {end:.2f} s").format(
                    name=section.name, begin=section.begin_s, end=section.end_s
                )
            QToolTip.showText(event.globalPos(), text, self)
            return True
        return super().event(event)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the sections, what has been played, and the head."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self)
        track = self._track()
        shape = QPainterPath()
        shape.addRoundedRect(track, 4, 4)
        painter.fillPath(shape, theme.color("raised"))
        if self._duration_s > 0:
            played = QRectF(track)
            played.setRight(self._x_of(self._time_s))
            tint = theme.color("accent")
            tint.setAlphaF(0.30)
            painter.save()
            painter.setClipPath(shape)
            painter.fillRect(played, tint)
            plate = self._plate(track, QFontMetricsF(smaller(self.font())))
            self._paint_sections(painter, track, plate)
            painter.restore()
            self._paint_current(painter, plate)
            self._paint_head(painter, track)
        painter.end()

    def _paint_sections(self, painter: QPainter, track: QRectF, plate: QRectF) -> None:
        theme = theme_of(self)
        painter.setFont(smaller(self.font()))
        metrics = QFontMetricsF(painter.font())
        for section in self._sections:
            left, right = self._x_of(section.begin_s), self._x_of(section.end_s)
            if section.begin_s > 0:
                painter.setPen(QPen(theme.color("window"), 2))
                painter.drawLine(QPointF(left, track.top()), QPointF(left, track.bottom()))
            box = QRectF(left + 5, track.top(), right - left - 8, track.height())
            text = metrics.elidedText(section.name, Qt.TextElideMode.ElideRight, box.width())
            is_readable = text == section.name or len(text) >= _LEAST_LETTERS
            if is_readable and not box.intersects(plate):
                painter.setPen(theme.color("text"))
                painter.drawText(box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, text)

    def _plate(self, track: QRectF, metrics: QFontMetricsF) -> QRectF:
        """Where the current section's name goes if its own room is too small; empty if it is not."""
        section = self.section_at(self._time_s)
        if section is None:
            return QRectF()
        width = metrics.horizontalAdvance(section.name) + 10
        if width <= self._x_of(section.end_s) - self._x_of(section.begin_s):
            return QRectF()
        x = self._x_of(self._time_s) + 2
        left = x if x + width <= track.right() else x - 4 - width
        return QRectF(left, track.top(), width, track.height())

    def _paint_current(self, painter: QPainter, plate: QRectF) -> None:
        section = self.section_at(self._time_s)
        if section is None or plate.isEmpty():
            return
        theme = theme_of(self)
        painter.setPen(theme.color("muted"))
        painter.setBrush(theme.color("window"))
        painter.drawRoundedRect(plate.adjusted(0.5, 0.5, -0.5, -0.5), 3, 3)
        painter.setFont(smaller(self.font()))
        painter.setPen(theme.color("text"))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, section.name)

    def _paint_head(self, painter: QPainter, track: QRectF) -> None:
        theme = theme_of(self)
        x = self._x_of(self._time_s)
        painter.setPen(QPen(theme.color("accent"), 2))
        painter.drawLine(QPointF(x, track.top() - 2), QPointF(x, track.bottom()))
        half = _HEAD_PX - 2
        head = QPolygonF([QPointF(x - half, 0.5), QPointF(x + half, 0.5), QPointF(x, half + 3.5)])
        painter.setPen(QPen(theme.color("text"), 1.5) if self.hasFocus() else Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("accent"))
        painter.drawPolygon(head)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show that keys act here."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that keys act elsewhere."""
        super().focusOutEvent(event)
        self.update()

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
