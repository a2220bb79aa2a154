"""The window's end of the STOP process: started with an arm, kept at its place, started again if it ends."""

from __future__ import annotations

import threading
from contextlib import suppress

from PySide6.QtCore import QEvent, QObject, QPoint, Qt, Signal
from PySide6.QtWidgets import QWidget
from typing_extensions import override

from app.gui.desk.arm_link import ArmLink
from app.gui.stop.messages import Answered, Dock, Pressed
from app.gui.theme import theme_of
from core.child_process import ChildProcess

_MOVED = (QEvent.Type.Move, QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.WindowStateChange)


class StopDock(QObject):
    """Shows STOP as a process of its own over its place in the window, as long as an arm has a channel.

    Signals: `pressed`, when STOP was pressed there; `answered` with the `Answered` of a press.
    """

    pressed = Signal()
    answered = Signal(object)
    _started = Signal(str, object)
    _heard = Signal(object, object)

    def __init__(self, window: QWidget, place: QWidget, arm: ArmLink) -> None:
        """Follow `arm`; `place` is the widget of `window` that STOP lies over."""
        super().__init__(window)
        self._place, self._arm = place, arm
        self._address: str | None = None
        self._process: ChildProcess | None = None
        arm.changed.connect(self._follow)
        self._started.connect(self._adopt, Qt.ConnectionType.QueuedConnection)
        self._heard.connect(self._take, Qt.ConnectionType.QueuedConnection)
        for widget in (window, place):
            widget.installEventFilter(self)

    @property
    def pid(self) -> int | None:
        """Of the process that shows STOP; none without an arm."""
        return None if self._process is None else self._process.pid

    def close(self) -> None:
        """End the process."""
        self._arm.changed.disconnect(self._follow)
        self._address = None
        self._end()

    @override
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in _MOVED and self._process is not None:
            with suppress(OSError):
                self._process.connection.send(self._dock())
        return False

    def _follow(self) -> None:
        arm = self._arm.connected
        address = None if arm is None else arm.stop_address
        if address != self._address:
            self._address = address
            self._end()
            self._start()

    def _start(self) -> None:
        if self._address is not None:
            arguments = self._address, theme_of(self._place).name, self._dock()
            threading.Thread(target=self._run, args=arguments, daemon=True).start()

    def _run(self, address: str, theme: str, dock: Dock) -> None:
        """Start the process and listen to it, in a thread of its own: the window has no time for a start."""
        from app.gui.stop.process import show_stop

        child = ChildProcess(show_stop, address, theme, dock, name="poursight STOP")
        with suppress(RuntimeError):  # the window is gone
            self._started.emit(address, child)
            self._listen(child)

    def _adopt(self, address: str, child: ChildProcess) -> None:
        if address == self._address and self._process is None:
            self._process = child
        else:
            child.end()

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.end()

    def _dock(self) -> Dock:
        corner = self._place.mapToGlobal(QPoint(0, 0))
        return Dock(corner.x(), corner.y(), self._place.width(), self._place.height())

    def _listen(self, child: ChildProcess) -> None:
        message: object = ""
        while message is not None:
            try:
                message = child.connection.recv()
            except (EOFError, OSError):
                message = None
            self._heard.emit(child, message)

    def _take(self, child: ChildProcess, message: object) -> None:
        if isinstance(message, Pressed):
            self.pressed.emit()
        elif isinstance(message, Answered):
            self.answered.emit(message)
        elif child is self._process:  # it ended by itself
            self._end()
            self._start()
