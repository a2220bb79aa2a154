"""The process that shows STOP and holds the arm's stop channel.

It runs before every ordinary process, where the system allows it, and does nothing until it is pressed.
"""

from __future__ import annotations

import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from multiprocessing.connection import Connection

from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtWidgets import QApplication

from app.gui.stop.messages import Answered, Dock, Pressed
from app.gui.stop.panel import StopPanel
from app.gui.theme import apply_theme, theme_named
from core.errors import PoursightError
from hardware.realtime import take_precedence
from hardware.robots.ur.stop_line import StopLine

_LOOK_MS = 500
_STOPS_AT_ONCE = 4


def show_stop(connection: Connection, address: str, theme: str, place: Dock) -> None:
    """Show STOP until the window ends this process.

    Args:
        connection: to the window: `Dock` comes in, `Pressed` and `Answered` go out.
        address: of the controller.
        theme: the window's, by name.
        place: where to show it.
    """
    application = QApplication(sys.argv[:1])
    apply_theme(application, theme_named(theme))
    stop = _Stop(connection, StopLine(address))
    stop.panel.dock(place)
    stop.panel.show()
    take_precedence()  # not before: to come up takes long, and would hold up the window
    application.exec()


class _Stop(QObject):
    """Joins panel, channel and window; no press waits for either of the others."""

    _docked = Signal(object)
    _answered = Signal(object)
    _left = Signal()

    def __init__(self, connection: Connection, line: StopLine) -> None:
        super().__init__()
        self.panel = StopPanel()
        self._connection, self._line = connection, line
        self._stops = ThreadPoolExecutor(_STOPS_AT_ONCE, "stop")
        # The window may be stopped or busy, and its end of the pipe full: nobody waits for it.
        self._telling = ThreadPoolExecutor(1, "tell")
        queued = Qt.ConnectionType.QueuedConnection
        self.panel.pressed.connect(self._press)
        self._docked.connect(self.panel.dock, queued)
        self._answered.connect(self._show_answer, queued)
        self._left.connect(QApplication.quit, queued)
        self._look = QTimer(self, interval=_LOOK_MS)
        self._look.timeout.connect(self._show_channel)
        self._look.start()
        self._show_channel()
        threading.Thread(target=self._listen, daemon=True).start()

    def _press(self) -> None:
        self._stops.submit(self._stop, time.monotonic())
        self._tell(Pressed())

    def _stop(self, pressed_s: float) -> None:
        problem = ""
        try:
            self._line.stop()
        except PoursightError as error:
            problem = str(error)
        answered = Answered(time.monotonic() - pressed_s, problem)
        self._answered.emit(answered)
        self._tell(answered)

    def _tell(self, message: object) -> None:
        def send() -> None:
            with suppress(OSError):
                self._connection.send(message)

        self._telling.submit(send)

    def _show_answer(self, answered: Answered) -> None:
        self.panel.show_answer(answered)
        self._show_channel()

    def _show_channel(self) -> None:
        self.panel.show_channel(self._line.is_open)

    def _listen(self) -> None:
        with suppress(EOFError, OSError):
            while True:
                self._docked.emit(self._connection.recv())
        self._left.emit()
