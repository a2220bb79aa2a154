"""What the window knows of the arm, and STOP with its own way to the controller."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus, StopDone
from app.jobs.arm_work import ArmWork
from app.jobs.host import Host
from app.jobs.scan_work import ScanWork
from core.errors import PoursightError

if TYPE_CHECKING:
    from hardware.robots.ur.stop_line import StopLine

CONFIRMED_WITHIN_S = 1.0
"""A stop that nobody has confirmed after this time is told as one that failed."""
SILENT_AFTER_S = 1.5
_LOOK_MS = 250
_STOPS_AT_ONCE = 4


class ArmLink(QObject):
    """Keeps the newest state of the connected arm.

    STOP goes three ways at once: to the process that pours, to the one that scans, and over a socket of the
    window's own straight to the controller's dashboard. It needs no job to listen, and none of these ways
    waits for another. Each press is answered once: by the first way that succeeded, or with what was in the
    way.

    Signals: `changed` when something of the attributes did; `stopped` with the `StopDone` of a press.

    Attributes:
        connected: which arm; none if none is.
        status: the newest; none before the first.
        farewell: why there is no arm any more, in a sentence; empty if none was, or it was wished.
    """

    changed = Signal()
    stopped = Signal(object)
    _line_said = Signal(float, object)

    def __init__(self, arm: Host[ArmWork], scan: Host[ScanWork], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.connected: ArmConnected | None = None
        self.status: ArmStatus | None = None
        self.farewell = ""
        self._arm, self._scan = arm, scan
        self._line: StopLine | None = None
        self._stops = ThreadPoolExecutor(_STOPS_AT_ONCE, "stop")
        self._heard_s = 0.0
        self._was_silent = False
        self._pressed_s: float | None = None
        self._failure = ""
        self._line_said.connect(self._hear_line, Qt.ConnectionType.QueuedConnection)
        self._patience = QTimer(self, singleShot=True, interval=round(1000 * CONFIRMED_WITHIN_S))
        self._patience.timeout.connect(self._give_up)
        self._look = QTimer(self, interval=_LOOK_MS)
        self._look.timeout.connect(self._look_after)

    @property
    def is_ours_to_pour(self) -> bool:
        """Whether the process that pours holds the arm, not the one that scans."""
        return self.connected is not None and self.connected.pid == self._arm.pid

    @property
    def is_silent(self) -> bool:
        """Whether the process that holds the arm tells nothing, so that what is shown is old."""
        return self.connected is not None and time.monotonic() - self._heard_s > SILENT_AFTER_S

    @property
    def has_stop_line(self) -> bool:
        """Whether the window's own line to the controller is open now."""
        return self._line is not None and self._line.is_open

    def hear(self, news: object) -> None:
        """Take over what a host told; anything else is left alone."""
        if isinstance(news, ArmConnected):
            self._take(news)
        elif isinstance(news, ArmGone):
            self._leave(news.sentence)
        elif isinstance(news, ArmStatus):
            self.status, self._heard_s = news, time.monotonic()
            self.changed.emit()
        elif isinstance(news, StopDone) and self._pressed_s is not None:
            self._answer(StopDone(time.monotonic() - self._pressed_s, news.sentence))

    def stop(self) -> None:
        """Stop whatever moves, now; `stopped` tells when the controller has taken it."""
        pressed_s = self._pressed_s = time.monotonic()
        self._failure = ""
        if self._line is not None:
            self._stops.submit(self._stop_by_line, self._line, pressed_s)
        self._arm.order(ArmWork.stop)
        self._scan.order(ScanWork.stop)
        if self.connected is None:
            self._failure = self.tr("No arm is connected: there was nothing to stop.")
            self._give_up()
        else:
            self._patience.start()

    def close(self) -> None:
        """Close the line."""
        self._look.stop()
        self._patience.stop()
        self._line_said.disconnect(self._hear_line)
        self._close_line()
        self._stops.shutdown(wait=False, cancel_futures=True)

    def _take(self, arm: ArmConnected) -> None:
        from hardware.robots.ur.stop_line import StopLine

        self._close_line()
        self.connected, self.status, self.farewell = arm, None, ""
        self._heard_s, self._was_silent = time.monotonic(), False
        if arm.stop_address is not None:
            self._line = StopLine(arm.stop_address)
        self._look.start()
        self.changed.emit()

    def _leave(self, sentence: str) -> None:
        if self._pressed_s is not None and self._line is None and not sentence:
            self._answer(StopDone(time.monotonic() - self._pressed_s))  # what is let go stands
        self.connected = self.status = None
        self.farewell = sentence
        self._look.stop()
        self._close_line()
        self.changed.emit()

    def _look_after(self) -> None:
        """Notice a process that is gone without a word, and one that says nothing any more."""
        arm = self.connected
        if arm is not None and arm.pid not in (self._arm.pid, self._scan.pid):
            self._leave(self._death_notice(arm))
        elif self.is_silent != self._was_silent:
            self._was_silent = self.is_silent
            self.changed.emit()

    def _death_notice(self, arm: ArmConnected) -> str:
        if arm.is_simulated:
            return self.tr(
                "The process that moves the arm has ended unexpectedly, and the {name} with it; connect "
                "again: it starts anew at its home."
            ).format(name=arm.name)
        return self.tr(
            "The process that moves the arm has ended unexpectedly; the controller of the {name} stops an "
            "arm that nobody watches. See that it stands, then connect again."
        ).format(name=arm.name)

    def _stop_by_line(self, line: StopLine, pressed_s: float) -> None:
        """In a thread of its own."""
        said = ""
        try:
            line.stop()
        except PoursightError as error:
            said = str(error)
        self._line_said.emit(pressed_s, StopDone(time.monotonic() - pressed_s, said))

    def _hear_line(self, pressed_s: float, done: StopDone) -> None:
        if pressed_s == self._pressed_s:
            self._answer(done)

    def _answer(self, done: StopDone) -> None:
        """Tell of the first way that succeeded; keep in mind what failed."""
        if done.sentence:
            self._failure = self._failure or done.sentence
            return
        self._pressed_s = None
        self._patience.stop()
        self.stopped.emit(done)

    def _give_up(self) -> None:
        if self._pressed_s is None:
            return
        seconds, self._pressed_s = time.monotonic() - self._pressed_s, None
        said = self._failure or self.tr(
            "Nobody has confirmed the stop; press the emergency stop if the arm moves."
        )
        self.stopped.emit(StopDone(seconds, said))

    def _close_line(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            line.close()
