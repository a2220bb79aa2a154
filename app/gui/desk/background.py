"""Reading files and other short work in a thread, its result back in the window's."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.gui.remedies import worded
from core.errors import PoursightError, StageError

R = TypeVar("R")


@dataclass(frozen=True, eq=False)
class _Call:
    """What is called in the thread, and what is called with its end."""

    function: Callable[[], Any]
    done: Callable[[Any], None]
    failed: Callable[[PoursightError], None] | None


class Background(QObject):
    """Runs calls one by one in a thread; only the newest of each name is reported, so a page never goes back.

    One result is shown in a turn of the event loop: Qt would deliver all that came meanwhile in one, and what
    a user does would wait for them all.

    Signals: `failed` with the sentence of a call that failed and has no handler of its own.
    """

    failed = Signal(str)

    _ended = Signal(str, object, object, object)
    """Name, call, result, error; emitted in the thread, delivered in the window's."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        # Python's own: a `QRunnable` may be destroyed here while Qt's thread is still inside it.
        self._thread = ThreadPoolExecutor(1)
        self._newest: dict[str, _Call] = {}
        self._ends: deque[tuple[str, _Call, Any, PoursightError | None]] = deque()
        self._turn = QTimer(self, singleShot=True, interval=0)
        self._turn.timeout.connect(self._show_next)
        self._ended.connect(self._await_turn, Qt.ConnectionType.QueuedConnection)

    @property
    def is_idle(self) -> bool:
        """Whether nothing is queued or running."""
        return not self._newest

    def run(
        self,
        name: str,
        function: Callable[[], R],
        done: Callable[[R], None],
        failed: Callable[[PoursightError], None] | None = None,
    ) -> None:
        """Call a function in the thread, then `done` or `failed` here.

        Args:
            name: a newer call of the same name replaces an older one, whose result is dropped.
            function: must not touch widgets.
            done: called with the result.
            failed: called with what went wrong; without it the signal `failed` reports it.
        """
        call = _Call(function, done, failed)
        self._newest[name] = call
        self._thread.submit(self._call, name, call)

    def _call(self, name: str, call: _Call) -> None:
        """Run a call, in the thread."""
        result: Any = None
        error: PoursightError | None = None
        try:
            result = call.function()
        except PoursightError as reason:
            error = reason
        except Exception as fault:  # a bug: reported, so that nobody waits for ever
            error = StageError(f"Internal error ({type(fault).__name__}: {fault}).")
        self._ended.emit(name, call, result, error)

    def _await_turn(self, name: str, call: _Call, result: Any, error: PoursightError | None) -> None:
        self._ends.append((name, call, result, error))
        self._turn.start()

    def _show_next(self) -> None:
        end = self._ends.popleft()
        if self._ends:
            self._turn.start()
        self._end(*end)

    def _end(self, name: str, call: _Call, result: Any, error: PoursightError | None) -> None:
        if self._newest.get(name) is not call:
            return
        del self._newest[name]
        if error is None:
            call.done(result)
        elif call.failed is not None:
            call.failed(error)
        else:
            self.failed.emit(worded(error))

    def forget(self) -> None:
        """Drop what is queued, and wait for what runs."""
        self._newest.clear()
        self._turn.stop()
        self._ends.clear()
        self._thread.shutdown(cancel_futures=True)
        self._thread = ThreadPoolExecutor(1)
