"""Play, pause and scrub through something with named sections: a drop, a pour, a plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QElapsedTimer, QEvent, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QFontMetrics,
    QFontMetricsF,
    QHelpEvent,
    QHideEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QToolTip, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller, tabular

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
STEP_S = 1 / 24
"""Arrow keys step by one recorded frame."""
_TICK_MS = 40
_HEAD_PX = 8


@dataclass(frozen=True)
class Section:
    """A named stretch of time."""

    name: str
    begin_s: float
    end_s: float


class Timeline(QWidget):
    """Play/pause, a scrubber with sections, the time and the speed.

    Space toggles, left and right step by a frame, with Ctrl by a section, Home and End jump.

    Attributes:
        time_changed: the time in s, whatever changed it: playing, the user, `set_time`.
        playing_changed: whether it plays now.
    """

    time_changed = Signal(float)
    playing_changed = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("timeline")
        self._duration_s = 0.0
        self._time_s = 0.0
        self._sections: tuple[Section, ...] = ()
        self._from_s = 0.0
        self._clock = QElapsedTimer()
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(_TICK_MS)
        self._timer.timeout.connect(self._tick)
        self._build()
        self.set_sections(0.0, ())

    def _build(self) -> None:
        self._button = QPushButton(self.tr("Play"), self)
        self._button.setObjectName("timeline_play")
        self._button.setAutoDefault(False)
        self._button.setToolTip(self.tr("Play or pause (Space)"))
        self._button.clicked.connect(self.toggle)
        self._scrubber = Scrubber(self)
        self._scrubber.scrubbed.connect(self._scrub)
        self._label = QLabel(self)
        self._label.setObjectName("timeline_time")
        self._label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._speed = QComboBox(self)
        self._speed.setObjectName("timeline_speed")
        self._speed.setAccessibleName(self.tr("Speed"))
        self._speed.setToolTip(self.tr("Playback speed"))
        for speed in SPEEDS:
            self._speed.addItem(f"{speed:g}x", speed)
        self._speed.setCurrentIndex(SPEEDS.index(1.0))
        self._speed.currentIndexChanged.connect(self._restart_clock)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX)
        row.addWidget(self._button)
        row.addWidget(self._scrubber, 1)
        row.addWidget(self._label)
        row.addWidget(self._speed)
        metrics = QFontMetrics(self._button.font())
        words = (self.tr("Play"), self.tr("Pause"))
        self._button.setMinimumWidth(max(metrics.horizontalAdvance(word) for word in words) + 4 * GRID_PX)
        self._label.setFont(tabular(self.font()))
        self.setFocusProxy(self._scrubber)

    @property
    def time_s(self) -> float:
        """The time shown."""
        return self._time_s

    @property
    def duration_s(self) -> float:
        """How long it is; 0 while there is nothing to play."""
        return self._duration_s

    @property
    def is_playing(self) -> bool:
        """Whether it plays."""
        return self._timer.isActive()

    @property
    def speed(self) -> float:
        """Seconds shown in a second."""
        return float(self._speed.currentData())

    def set_sections(self, duration_s: float, sections: Sequence[Section] = ()) -> None:
        """Show another thing to play, at its beginning and paused; 0 s: nothing to play."""
        self.pause()
        self._duration_s = max(duration_s, 0.0)
        self._sections = tuple(sections)
        self._scrubber.set_sections(self._duration_s, self._sections)
        self._button.setEnabled(self._duration_s > 0)
        self._label.setMinimumWidth(
            QFontMetrics(self._label.font()).horizontalAdvance(self._time_text(self._duration_s)) + 2
        )
        self._time_s = -1.0
        self.set_time(0.0)

    def play(self) -> None:
        """Play on; at the end from the beginning."""
        if self._duration_s <= 0 or self.is_playing:
            return
        if self._time_s >= self._duration_s:
            self.set_time(0.0)
        self._restart_clock()
        self._timer.start()
        self._emit_playing()

    def pause(self) -> None:
        """Stop where it is."""
        if self.is_playing:
            self._timer.stop()
            self._emit_playing()

    def toggle(self) -> None:
        """Pause if it plays, else play."""
        if self.is_playing:
            self.pause()
        else:
            self.play()

    def set_time(self, time_s: float) -> None:
        """Go to a time, limited to the duration; playing goes on from there."""
        time_s = min(max(time_s, 0.0), self._duration_s)
        if time_s == self._time_s:
            return
        self._show(time_s)
        self._restart_clock()

    def _show(self, time_s: float) -> None:
        self._time_s = time_s
        self._scrubber.set_time(time_s)
        self._label.setText(self._time_text(time_s))
        self.time_changed.emit(time_s)

    def _time_text(self, time_s: float) -> str:
        return self.tr("{time:.1f} / {duration:.1f} s").format(time=time_s, duration=self._duration_s)

    def _restart_clock(self) -> None:
        """Count from here: at another time, or at another speed."""
        self._from_s = self._time_s
        self._clock.start()

    def _tick(self) -> None:
        time_s = self._from_s + self.speed * self._clock.elapsed() / 1000
        self._show(min(time_s, self._duration_s))
        if time_s >= self._duration_s:
            self.pause()

    def _emit_playing(self) -> None:
        self._button.setText(self.tr("Pause") if self.is_playing else self.tr("Play"))
        self.playing_changed.emit(self.is_playing)

    def _scrub(self, time_s: float) -> None:
        self.pause()
        self.set_time(time_s)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Toggle, step and jump."""
        if event.key() == Qt.Key.Key_Space:
            if not event.isAutoRepeat():
                self.toggle()
            return
        target = self._key_target(event)
        if target is None:
            super().keyPressEvent(event)
        else:
            self._scrub(target)

    def _key_target(self, event: QKeyEvent) -> float | None:
        by_section = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        starts = sorted({0.0, self._duration_s, *(section.begin_s for section in self._sections)})
        match event.key():
            case Qt.Key.Key_Left if by_section:
                return max((start for start in starts if start < self._time_s - 1e-6), default=0.0)
            case Qt.Key.Key_Right if by_section:
                return min(
                    (start for start in starts if start > self._time_s + 1e-6), default=self._duration_s
                )
            case Qt.Key.Key_Left:
                return self._time_s - STEP_S
            case Qt.Key.Key_Right:
                return self._time_s + STEP_S
            case Qt.Key.Key_Home:
                return 0.0
            case Qt.Key.Key_End:
                return self._duration_s
        return None

    def hideEvent(self, event: QHideEvent) -> None:
        """Nothing plays unseen."""
        self.pause()
        super().hideEvent(event)


class Scrubber(QWidget):
    """Sections side by side in proportion to their time, and the play head.

    Attributes:
        scrubbed: the time in s to which the user dragged or clicked.
    """

    scrubbed = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("timeline_scrubber")
        self.setAccessibleName(self.tr("Timeline"))
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
        """Return the section that contains a time."""
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
        """Show the section under the mouse."""
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
            box = QRectF(left + 5, track.top(), right - left - 7, track.height())
            # A name that has no room is written on a plate when its section is the current one.
            if metrics.horizontalAdvance(section.name) <= box.width() and not box.intersects(plate):
                painter.setPen(theme.color("text"))
                painter.drawText(
                    box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, section.name
                )

    def _plate(self, track: QRectF, metrics: QFontMetricsF) -> QRectF:
        """Where the current section's name goes if its section is too narrow; empty if it fits."""
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
