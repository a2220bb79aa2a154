"""Starting the desktop: as little as possible before the window is on the screen."""

from __future__ import annotations

import gc
import os
import signal
import sys
from contextlib import suppress

from PySide6.QtCore import QCoreApplication, Qt, QTimer
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QApplication

from app.gui.actions import WindowActions
from app.gui.desk.memory import Memory
from app.gui.palette import apply_theme
from app.gui.theme import DARK, LIGHT, THEMES, Theme
from app.gui.window import MainWindow
from core.errors import InputError

NO_SCREEN = (
    "There is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set); 'poursight demo' does the whole job "
    "without one."
)


def make_application() -> QApplication:
    """Return the program's QApplication, made when there is none yet.

    Raises:
        InputError: there is no screen to show a window on.
    """
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    platform = os.environ.get("QT_QPA_PLATFORM", "")
    if sys.platform == "linux" and not platform and not has_screen():
        raise InputError(NO_SCREEN)
    QCoreApplication.setAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    QCoreApplication.setOrganizationName("Poursight")
    QCoreApplication.setApplicationName("Poursight")
    return QApplication(sys.argv[:1])


def has_screen() -> bool:
    """Whether a window could be shown."""
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def theme_named(name: str) -> Theme:
    """Return a theme by its name; `system`: what the desktop around us uses."""
    if name in THEMES:
        return THEMES[name]
    is_dark = QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark
    return DARK if is_dark else LIGHT


def open_window(application: QApplication) -> MainWindow:
    """Show the window as it was left, and begin what takes its time."""
    memory = Memory()
    apply_theme(application, theme_named(memory.theme))
    window = MainWindow(memory)
    window.setMenuBar(WindowActions(window).menus)
    if memory.geometry is not None:
        window.restoreGeometry(memory.geometry)
    _collect_once_ready(window)
    window.show()
    QTimer.singleShot(0, window.begin)
    window.offer_cut_off_session()
    return window


def _collect_once_ready(window: MainWindow) -> None:
    """Look for garbage only when all is imported, and never again in what is there by then.

    It is much and stays for good, and to go through all of it stops every thread for a tenth of a second.
    """

    def collect() -> None:
        gc.freeze()
        gc.enable()

    gc.disable()
    window.ready.connect(collect)


def run() -> int:
    """Run the desktop until its window is closed; return the exit code.

    Raises:
        InputError: there is no screen.
    """
    application = make_application()
    window = open_window(application)
    _close_on_signals(window)
    return application.exec()


def _close_on_signals(window: MainWindow) -> None:
    """Ctrl-C and a polite kill close the window; Python only hears of them when it runs now and then."""

    def leave(*_: object) -> None:
        window.close_without_asking()

    for name in (signal.SIGINT, signal.SIGTERM):
        with suppress(ValueError):  # not in the main thread
            signal.signal(name, leave)
    listening = QTimer(window)
    listening.setInterval(200)
    listening.timeout.connect(lambda: None)
    listening.start()
