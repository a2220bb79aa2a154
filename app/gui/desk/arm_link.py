"""What the window knows of the arm, and STOP with its own way to the controller."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

from PySide6.QtCore import QObject, Qt, Signal

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus, StopDone
from app.jobs.arm_work import ArmWork
from app.jobs.host import Host
from app.jobs.scan_work import ScanWork
from core.errors import PoursightError


class ArmLink(QObject):
    """Keeps the newest state of the connected arm.

    STOP goes three ways at once: to the process that pours, to the one that scans, and over a socket of the
    window's own straight to the controller's dashboard. It needs no job to listen.

    Attributes:
        connected: which arm; none if none is.
        status: the newest; none before the first.
    """

    changed = Signal()
    stopped = Signal(object)
    _line_opened = Signal(object, object)

    def __init__(self, arm: Host[ArmWork], scan: Host[ScanWork], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.connected: ArmConnected | None = None
        self.status: ArmStatus | None = None
        self._arm, self._scan = arm, scan
        self._thread = ThreadPoolExecutor(1, "stop line")
        self._line: object | None = None
        self._line_opened.connect(self._keep_line, Qt.ConnectionType.QueuedConnection)

    def hear(self, news: object) -> None:
        """Take over what a host told; anything else is left alone."""
        if isinstance(news, ArmConnected):
            self.connected, self.status = news, None
            if news.stop_address is not None:
                self._thread.submit(self._open_line, news, news.stop_address)
        elif isinstance(news, ArmGone):
            self.connected = self.status = None
            self._close_line()
        elif isinstance(news, ArmStatus):
            self.status = news
        else:
            return
        self.changed.emit()

    def stop(self) -> None:
        """Stop whatever moves, now; `stopped` tells when the controller has taken it."""
        pressed_s = time.monotonic()
        self._thread.submit(self._stop_by_line, pressed_s)
        self._arm.order(ArmWork.stop)
        self._scan.order(ScanWork.stop)

    def close(self) -> None:
        """Close the line."""
        self._close_line()
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _open_line(self, arm: ArmConnected, address: str) -> None:
        from hardware.robots.ur.stop_line import StopLine

        try:
            self._line_opened.emit(arm, StopLine(address))
        except PoursightError:
            self._line_opened.emit(arm, None)  # the processes' own ways to stop remain

    def _keep_line(self, arm: ArmConnected, line: object) -> None:
        self._close_line()
        self._line = line if arm is self.connected else None

    def _stop_by_line(self, pressed_s: float) -> None:
        from hardware.robots.ur.stop_line import StopLine

        line = self._line
        if not isinstance(line, StopLine):
            return
        try:
            line.stop()
            said = ""
        except PoursightError as error:
            said = str(error)
        self.stopped.emit(StopDone(time.monotonic() - pressed_s, said))

    def _close_line(self) -> None:
        from hardware.robots.ur.stop_line import StopLine

        line, self._line = self._line, None
        if isinstance(line, StopLine):
            line.close()
