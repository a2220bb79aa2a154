"""What is slow at the start and need not be there when the window opens."""

from __future__ import annotations

import linecache
from collections.abc import Iterator
from importlib import import_module
from time import perf_counter

from PySide6.QtCore import QObject, QThread, QTimer, Signal
from typing_extensions import override

from app.gui.pages.registry import OTHERS, WORK, import_page

_QT = ("QtCore", "QtGui", "QtWidgets", "QtOpenGL", "QtOpenGLWidgets", "QtTest", "QtSvg")
"""What pyqtgraph imports of Qt."""
_OPENGL = "app.gui.views.scene.renderer"
"""Where pyqtgraph and PyOpenGL come in; a scene itself imports it when the first one is made."""
_SLICE_S = 0.01


class Preload(QObject):
    """Makes Qt's classes in the window's thread, a few at a time; then imports the slow modules in another.

    PySide makes a class when somebody first asks for it. Done in a thread, as by pyqtgraph, which asks for
    all of them, that crashed the window in one of about forty starts: decision 0045.

    Signals: `finished` when all of it is there.
    """

    finished = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._classes = _classes()
        self._imports = Imports(self)
        self._imports.finished.connect(self.finished)
        self._slices = QTimer(self, singleShot=True, interval=0)
        self._slices.timeout.connect(self.start)

    def start(self) -> None:
        """Begin; the window is on the screen by now."""
        end_s = perf_counter() + _SLICE_S
        for _ in self._classes:
            if perf_counter() > end_s:
                self._slices.start()
                return
        self._imports.start()

    def close(self) -> None:
        """End it, or wait until it has ended."""
        self._slices.stop()
        self._imports.wait()


class Imports(QThread):
    """PySide looks into the source of whatever is imported, and Python keeps what was looked into.

    That were 320,000 lines in the end, 30 MB. They are given back after each import, so that the next one
    gets their memory.
    """

    @override
    def run(self) -> None:
        import_module(_OPENGL)
        for key in (*WORK, *OTHERS):
            linecache.clearcache()
            import_page(key)
        linecache.clearcache()


def _classes() -> Iterator[object]:
    """Ask for one of Qt's classes after the other."""
    for name in _QT:
        module = import_module(f"PySide6.{name}")
        for attribute in dir(module):
            yield getattr(module, attribute)
