"""Reading files and other short work in a thread, its result back in the window's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from PySide6.QtCore import QObject, QRunnable, QThreadPool, Signal

from core.errors import PoursightError, StageError

R = TypeVar("R")


class _Call(QObject, QRunnable):
    """One call in a thread of the pool."""

    ended = Signal(object, object)

    def __init__(self, function: Callable[[], Any]) -> None:
        QObject.__init__(self)
        QRunnable.__init__(self)
        self.setAutoDelete(False)
        self._function = function

    def run(self) -> None:
        """Call and tell."""
        try:
            result, error = self._function(), None
        except PoursightError as reason:
            result, error = None, reason
        except Exception as fault:  # of the program: told like everything else, so that nobody waits for ever
            result, error = None, StageError(f"A fault of the program ({type(fault).__name__}: {fault}).")
        self.ended.emit(result, error)


class Background(QObject):
    """Runs calls one by one in a thread; only the newest of each name is told, so a page never goes back.

    Signals: `told` with the sentence of a call that failed and had nobody to hear of it.
    """

    told = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(1)
        self._newest: dict[str, _Call] = {}

    @property
    def is_idle(self) -> bool:
        """Whether nothing is under way."""
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
            done: told the result.
            failed: told what went wrong; without it `told` says it to the user.
        """
        call = _Call(function)
        self._newest[name] = call

        def end(result: Any, error: PoursightError | None) -> None:
            if self._newest.get(name) is not call:
                return
            del self._newest[name]
            if error is None:
                done(result)
            elif failed is not None:
                failed(error)
            else:
                self.told.emit(str(error))

        call.ended.connect(end)
        self._pool.start(call)

    def forget(self) -> None:
        """Drop what is under way."""
        self._newest.clear()
        self._pool.clear()
        self._pool.waitForDone()
