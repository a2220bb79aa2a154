"""The state of the arm, and STOP with its own channel to the controller."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.jobs.arm_events import ArmConnected, ArmDisconnected, ArmStatus, StopDone
from app.jobs.arm_work import ArmWork
from app.jobs.cell_work import CellWork
from app.jobs.host import Host
from core.errors import PoursightError

if TYPE_CHECKING:
    from core.geometry import FloatArray
    from hardware.robots.ur.stop_line import StopLine

CONFIRMED_WITHIN_S = 1.0
"""A stop that nobody has confirmed after this time is reported as failed."""
SILENT_AFTER_S = 1.5
_WATCH_MS = 250
_STOPS_AT_ONCE = 4


class ArmLink(QObject):
    """Holds the newest state of the connected arm.

    STOP goes over three channels at once: to the process that pours, to the one that scans, and over a socket
    of the window's own straight to the controller's dashboard. It needs no job to listen, and no channel
    waits for another. Each press is answered once: by the first channel that succeeded, or with the reason
    why none did.

    Signals: `changed` when something of the attributes did; `stopped` with the `StopDone` of a press.

    Attributes:
        connected: which arm; none if none is.
        status: the newest; none before the first one.
        farewell: why the arm is no longer connected, in a sentence; empty if that was requested.
        last_seen_rad: (6,) joint angles as the arm reported them last, also once it is disconnected.
        was_stopped: whether STOP was pressed, and no arm has been connected since.
    """

    changed = Signal()
    stopped = Signal(object)
    _line_answered = Signal(float, object)

    def __init__(self, arm: Host[ArmWork], scan: Host[CellWork], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.connected: ArmConnected | None = None
        self.status: ArmStatus | None = None
        self.farewell = ""
        self.last_seen_rad: FloatArray | None = None
        self.was_stopped = False
        self._arm, self._scan = arm, scan
        self._line: StopLine | None = None
        self._stops = ThreadPoolExecutor(_STOPS_AT_ONCE, "stop")
        self._heard_s = 0.0
        self._was_silent = False
        self._pressed_s: float | None = None
        self._failure = ""
        self._line_answered.connect(self._handle_line, Qt.ConnectionType.QueuedConnection)
        self._confirmation = QTimer(self, singleShot=True, interval=round(1000 * CONFIRMED_WITHIN_S))
        self._confirmation.timeout.connect(self._give_up)
        self._watch = QTimer(self, interval=_WATCH_MS)
        self._watch.timeout.connect(self._check_host)

    @property
    def is_ours_to_pour(self) -> bool:
        """Whether the process that pours holds the arm, not the one that scans."""
        return self.connected is not None and self.connected.pid == self._arm.pid

    @property
    def is_silent(self) -> bool:
        """Whether the process that holds the arm reports nothing, so that what is shown is old."""
        return self.connected is not None and time.monotonic() - self._heard_s > SILENT_AFTER_S

    @property
    def has_stop_line(self) -> bool:
        """Whether the window's own channel to the controller is open now."""
        return self._line is not None and self._line.is_open

    def handle(self, event: object) -> None:
        """Take a host's event if it is about the arm."""
        if isinstance(event, ArmConnected):
            self._take(event)
        elif isinstance(event, ArmDisconnected):
            self._leave(event.sentence)
        elif isinstance(event, ArmStatus):
            self.status, self._heard_s = event, time.monotonic()
            if event.state is not None:
                self.last_seen_rad = event.state.joints_rad
            self.changed.emit()
        elif isinstance(event, StopDone) and self._pressed_s is not None:
            self._answer(StopDone(time.monotonic() - self._pressed_s, event.sentence))

    def stop(self) -> None:
        """Stop whatever moves, now; `stopped` reports when the controller has confirmed it."""
        pressed_s = self._pressed_s = time.monotonic()
        self._failure = ""
        if self._line is not None:
            self._stops.submit(self._stop_by_line, self._line, pressed_s)
        self._arm.order(ArmWork.stop)
        self._scan.order(CellWork.stop)
        if self.connected is None:
            self._failure = self.tr("No arm is connected: there was nothing to stop.")
            self._give_up()
        else:
            self.was_stopped = True
            self._confirmation.start()

    def forget_place(self) -> None:
        """Another cell was chosen: what was seen of the former one's arm says nothing of this one's."""
        if self.connected is None:
            self.last_seen_rad, self.was_stopped = None, False

    def close(self) -> None:
        """Close the channel."""
        self._watch.stop()
        self._confirmation.stop()
        self._line_answered.disconnect(self._handle_line)
        self._close_line()
        self._stops.shutdown(wait=False, cancel_futures=True)

    def _take(self, arm: ArmConnected) -> None:
        from hardware.robots.ur.stop_line import StopLine

        self._close_line()
        self.connected, self.status, self.farewell = arm, None, ""
        self.last_seen_rad, self.was_stopped = None, False
        self._heard_s, self._was_silent = time.monotonic(), False
        if arm.stop_address is not None:
            self._line = StopLine(arm.stop_address)
        self._watch.start()
        self.changed.emit()

    def _leave(self, sentence: str) -> None:
        if self._pressed_s is not None and self._line is None and not sentence:
            self._answer(StopDone(time.monotonic() - self._pressed_s))  # a released arm is at rest
        self.connected = self.status = None
        self.farewell = sentence
        self._watch.stop()
        self._close_line()
        self.changed.emit()

    def _check_host(self) -> None:
        """Notice a process that died, and one that has gone silent."""
        arm = self.connected
        if arm is not None and arm.pid not in (self._arm.pid, self._scan.pid):
            self._leave(self._death_notice(arm))
        elif self.is_silent != self._was_silent:
            self._was_silent = self.is_silent
            self.changed.emit()

    def _death_notice(self, arm: ArmConnected) -> str:
        if arm.is_simulated:
            return self.tr(
                "The process that moves the arm has ended unexpectedly, and the {name} with it. Connect "
                "again; it starts at its home position."
            ).format(name=arm.name)
        return self.tr(
            "The process that moves the arm has ended unexpectedly; the controller of the {name} then stops "
            "the arm. Make sure that it has stopped, then connect again."
        ).format(name=arm.name)

    def _stop_by_line(self, line: StopLine, pressed_s: float) -> None:
        """In a thread of its own."""
        problem = ""
        try:
            line.stop()
        except PoursightError as error:
            problem = str(error)
        self._line_answered.emit(pressed_s, StopDone(time.monotonic() - pressed_s, problem))

    def _handle_line(self, pressed_s: float, done: StopDone) -> None:
        if pressed_s == self._pressed_s:
            self._answer(done)

    def _answer(self, done: StopDone) -> None:
        """Report the first channel that succeeded; remember what failed."""
        if done.sentence:
            self._failure = self._failure or done.sentence
            return
        self._pressed_s = None
        self._confirmation.stop()
        self.stopped.emit(done)

    def _give_up(self) -> None:
        if self._pressed_s is None:
            return
        seconds, self._pressed_s = time.monotonic() - self._pressed_s, None
        problem = self._failure or self.tr(
            "The controller has not confirmed the stop: press the emergency stop if the arm moves."
        )
        self.stopped.emit(StopDone(seconds, problem))

    def _close_line(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            line.close()
