"""The start on a real screen: one window, and no other that flashes up."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QWindow
from PySide6.QtWidgets import QApplication, QWidget

from app.gui.main import open_window

pytestmark = pytest.mark.gl


class _Shown(QObject):
    """Remembers every window that is shown."""

    def __init__(self) -> None:
        super().__init__()
        self.windows: list[str] = []

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        is_window = isinstance(watched, QWindow) or (isinstance(watched, QWidget) and watched.isWindow())
        if event.type() == QEvent.Type.Show and is_window:
            self.windows.append(f"{type(watched).__name__} {watched.objectName()}")
        return False


def test_no_other_window_is_shown_until_all_is_ready_and_every_page_was_seen(qtbot, forgetful):
    application = QApplication.instance()
    shown = _Shown()
    application.installEventFilter(shown)
    window = open_window(application)
    try:
        with qtbot.waitSignal(window.ready):
            pass
        for key in ("scan", "robot", "history", "welcome"):
            window.show_page(key)
            qtbot.wait(200)
    finally:
        window.close_without_asking()
        application.removeEventFilter(shown)
    assert sorted(shown.windows) == ["MainWindow ", "QWindow MainWindowClassWindow"]
