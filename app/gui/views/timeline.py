"""Play, pause and scrub through something with named sections: a drop, a pour, a plan."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QElapsedTimer, QEvent, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QFontMetrics, QHideEvent, QKeyEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.painting import tabular
from app.gui.views.scrubber import Scrubber, Section

__all__ = ["Section", "Timeline"]

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
STEP_S = 1 / 24
"""Arrow keys step by one recorded frame."""
_TICK_MS = 40


class Timeline(QWidget):
    """Play/pause, a scrubber with sections, the time and the speed.

    Space toggles, left and right step by a frame, with Ctrl by a section, Home and End jump.

    Attributes:
        time_changed: the time in s, from whatever it was changed: playing, the user, `set_time`.
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
        self._speed.setToolTip(self.tr("Speed against real time"))
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
        self._fit_widths()
        self.setFocusProxy(self._scrubber)

    def _fit_widths(self) -> None:
        metrics = QFontMetrics(self._button.font())
        words = (self.tr("Play"), self.tr("Pause"))
        self._button.setMinimumWidth(max(metrics.horizontalAdvance(word) for word in words) + 4 * GRID_PX)
        self._label.setFont(tabular(self.font()))

    @property
    def time_s(self) -> float:
        """Where it stands."""
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

    def set_speed(self, speed: float) -> None:
        """Choose one of `SPEEDS`."""
        self._speed.setCurrentIndex(SPEEDS.index(speed))

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
        """Play on; from the beginning where it stands at the end."""
        if self._duration_s <= 0 or self.is_playing:
            return
        if self._time_s >= self._duration_s:
            self.set_time(0.0)
        self._restart_clock()
        self._timer.start()
        self._tell_playing()

    def pause(self) -> None:
        """Stop where it is."""
        if self.is_playing:
            self._timer.stop()
            self._tell_playing()

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

    def _tell_playing(self) -> None:
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

    def changeEvent(self, event: QEvent) -> None:
        """Keep the widths that the words need."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.FontChange:
            with QSignalBlocker(self):
                self._fit_widths()
