"""Starting the desktop: as little as possible before the window is on the screen."""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import sys
from contextlib import suppress

from PySide6.QtCore import QCoreApplication, QTimer
from PySide6.QtWidgets import QApplication

from app.gui.desk.memory import Memory
from app.gui.shell.menus import Menus
from app.gui.shell.window import MainWindow
from app.gui.theme import apply_theme, theme_named
from core.errors import InputError

COLLECT_EVERY_MS = 1000
FIRST_PAINT_MS = 50
"""Imports in a thread hold the interpreter's lock: with them the first paint took up to twice as long."""
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_LARGE_BYTES = 2**19
_SCREEN_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")


def make_application() -> QApplication:
    """Return the program's QApplication, made when there is none yet.

    Raises:
        InputError: there is no screen to show a window on.
    """
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    if sys.platform == "linux" and not any(map(os.environ.get, _SCREEN_VARIABLES)):
        raise InputError(
            "There is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set); 'poursight demo' does the "
            "whole job without one."
        )
    _give_back_large_memory()
    QCoreApplication.setOrganizationName("Poursight")
    QCoreApplication.setApplicationName("Poursight")
    return QApplication(sys.argv[:1])


def _give_back_large_memory() -> None:
    """Have the C library give large blocks back to the system as soon as they are free.

    It learns from the first ones freed to keep the next, and pictures and models leave holes: after five
    rounds through all pages 573 MB were 528. Source: mallopt(3); glibc alone has it.
    """
    with suppress(AttributeError, OSError):
        library = ctypes.CDLL(None)
        library.mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
        library.mallopt(_M_TRIM_THRESHOLD, 2 * _LARGE_BYTES)


def open_window(application: QApplication) -> MainWindow:
    """Show the window as it was left, and start what is slow."""
    memory = Memory()
    apply_theme(application, theme_named(memory.theme))
    window = MainWindow(memory)
    window.setMenuBar(Menus(window))
    if memory.geometry is not None:
        window.restoreGeometry(memory.geometry)
    _collect_once_ready(window)
    window.give_stop_a_process()
    window.show()
    QTimer.singleShot(FIRST_PAINT_MS, window.begin)
    window.offer_cut_off_session()
    return window


def _collect_once_ready(window: MainWindow) -> None:
    """Collect garbage in the window's thread alone, and never again what is there once all is imported.

    Python's own collector runs in whichever thread makes an object; a widget that is destroyed in another
    thread than the window's ends the process. What is imported is much and permanent: a search through it
    stops every thread for 0.1 s.
    """
    timer = QTimer(window, interval=COLLECT_EVERY_MS)
    timer.timeout.connect(collect_garbage)

    def begin() -> None:
        gc.freeze()
        timer.start()

    gc.disable()
    window.ready.connect(begin)


def collect_garbage() -> None:
    """Collect the oldest generation that is due, as Python would by itself."""
    counts, thresholds = gc.get_count(), gc.get_threshold()
    due = [generation for generation in (2, 1, 0) if counts[generation] > thresholds[generation]]
    if due:
        gc.collect(due[0])


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
    """Ctrl-C and SIGTERM close the window; Python notices signals only while it runs, hence the timer."""

    def leave(*_: object) -> None:
        window.close_without_asking()

    for name in (signal.SIGINT, signal.SIGTERM):
        with suppress(ValueError):  # not in the main thread
            signal.signal(name, leave)
    listening = QTimer(window)
    listening.setInterval(200)
    listening.timeout.connect(lambda: None)
    listening.start()
