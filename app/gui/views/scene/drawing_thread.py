"""The thread that draws 3D views: without a graphics card a picture takes longer than a window may stall."""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable
from concurrent.futures import Future
from functools import lru_cache
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TypeVar

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QOffscreenSurface, QOpenGLContext

if TYPE_CHECKING:
    from app.gui.views.scene.drawing_context import DrawingContext

R = TypeVar("R")
_END_S = 5.0


class _Relay(QObject):
    """Takes results to the window's thread.

    Signals: `ended` with whom to call there and what came.
    """

    ended = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self.ended.connect(self._call, Qt.ConnectionType.QueuedConnection)

    def _call(self, done: Callable[[Any], None], future: Future[Any]) -> None:
        done(future.result())


class DrawingThread:
    """Runs calls one after the other, in the only OpenGL context there is.

    Where Qt's platform cannot draw in another thread than the window's, calls run at once in that one.
    """

    def __init__(self) -> None:
        """Start it; to be called in the window's thread, in which alone a surface can be made."""
        self._surface = QOffscreenSurface()
        self._surface.create()
        self._relay = _Relay()
        self._calls: SimpleQueue[Callable[[DrawingContext], None] | None] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._context: DrawingContext | None = None
        if QOpenGLContext.supportsThreadedOpenGL():
            # A daemon, because Python waits for others before it calls `close`.
            self._thread = threading.Thread(target=self._work, name="3D views", daemon=True)
            self._thread.start()
        atexit.register(self.close)

    def run(self, function: Callable[[DrawingContext], R]) -> Future[R]:
        """Call a function with the context, after all that were handed in before; return what will come."""
        future: Future[R] = Future()

        def call(context: DrawingContext) -> None:
            try:
                future.set_result(function(context))
            except Exception as fault:  # whoever waits for it is told
                future.set_exception(fault)

        if self._thread is not None:
            self._calls.put(call)
        else:
            call(self._own_context())
        return future

    def run_then(self, function: Callable[[DrawingContext], R], done: Callable[[R], None]) -> None:
        """Call a function as `run` does, then `done` with its result in the window's thread."""
        self.run(function).add_done_callback(lambda future: self._relay.ended.emit(done, future))

    def close(self) -> None:
        """Do what was handed in, then give everything back."""
        if self._thread is not None:
            self._calls.put(None)
            self._thread.join(_END_S)

    def _work(self) -> None:
        context = self._own_context()
        while (call := self._calls.get()) is not None:
            call(context)
        context.close()

    def _own_context(self) -> DrawingContext:
        if self._context is None:
            from app.gui.views.scene.drawing_context import DrawingContext  # half a second: not the window's

            self._context = DrawingContext(self._surface)
        return self._context


@lru_cache
def drawing_thread() -> DrawingThread:
    """Return the program's one, started at the first call."""
    return DrawingThread()
