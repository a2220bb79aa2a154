"""Imports that take their time run in a thread once the window is on the screen, so that nobody waits."""

from __future__ import annotations

from importlib import import_module

from PySide6.QtCore import QObject, QThread, Signal
from typing_extensions import override

from app.gui.pages.registry import OTHERS, WORK, import_page

_OPENGL = "app.gui.views.scene.view"
"""Where pyqtgraph and PyOpenGL come in; the scene itself imports it when the first one is made."""


class _Importing(QThread):
    """Imports the pages' modules one after the other."""

    @override
    def run(self) -> None:
        import_module(_OPENGL)
        for key in (*WORK, *OTHERS):
            import_page(key)


class Warming(QObject):
    """Tells when the pages can be made without a pause."""

    done = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._thread = _Importing(self)
        self._thread.finished.connect(self.done)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def wait(self) -> None:
        """Return when it has ended."""
        self._thread.wait()
