"""Clicking through the window as a person would: by the buttons that can be seen and pressed."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from PySide6.QtCore import QEventLoop, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.gui.window import MainWindow
from core.errors import StageError

W = TypeVar("W", bound=QWidget)
_POLL_MS = 20


def let_work(seconds: float) -> None:
    """Run the event loop for a while; `QTest.qWait` would keep Python's other threads from their work."""
    loop = QEventLoop()
    QTimer.singleShot(round(1000 * seconds), loop.quit)
    loop.exec()


class WalkEnded(StageError):
    """The walk could not go on: a button was not there, or something took too long."""


class Walk:
    """Walks through a window.

    Attributes:
        window: that is walked through.
        clicks: how often something was clicked.
    """

    def __init__(self, window: MainWindow) -> None:
        self.window = window
        self.clicks = 0

    def wait(self, condition: Callable[[], object], what: str, within_s: float) -> None:
        """Let the window work until something is so.

        Raises:
            WalkEnded: it took too long, or a job failed meanwhile.
        """
        deadline_s = time.monotonic() + within_s
        while not condition():
            if time.monotonic() > deadline_s:
                said = self.window.messages.sentence
                raise WalkEnded(f"'{what}' did not happen within {within_s:.0f} s. {said}".rstrip())
            let_work(_POLL_MS / 1000)

    def wait_for_work(self, what: str, within_s: float) -> None:
        """Let the window work until nothing is under way."""
        self.wait(lambda: self.window.desk.jobs.is_idle, what, within_s)

    def shown(self, kind: type[W], name: str = "") -> W | None:
        """Return a widget that can be seen and used, in the frame or on the page; none if there is none."""
        found = self.window.findChildren(kind, name) if name else self.window.findChildren(kind)
        usable = (widget for widget in found if widget.isVisibleTo(self.window) and widget.isEnabled())
        return next(usable, None)

    def click(self, name: str, within_s: float = 5.0) -> None:
        """Click a button as soon as it can be clicked."""
        self.wait(lambda: self.shown(QAbstractButton, name), f"button '{name}'", within_s)
        button = self.shown(QAbstractButton, name)
        assert button is not None, "waited for"
        self.clicks += 1
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    def hold(self, name: str, seconds: float) -> None:
        """Press a button, hold it, and let it go."""
        self.wait(lambda: self.shown(QWidget, name), f"button '{name}'", 10)
        button = self.shown(QWidget, name)
        assert button is not None, "waited for"
        self.clicks += 1
        QTest.mousePress(button, Qt.MouseButton.LeftButton)
        let_work(seconds)
        QTest.mouseRelease(button, Qt.MouseButton.LeftButton)
