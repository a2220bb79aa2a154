"""The desktop's tests: widgets offscreen, those marked `gl` under Xvfb."""

from __future__ import annotations

import gc
import os

import pytest

pytest.importorskip("PySide6")
pytest.importorskip("pytestqt")

from PySide6.QtCore import QCoreApplication
from pytestqt.qtbot import QtBot

from tests.patience import HANG_S

QCoreApplication.setOrganizationName("Poursight")
QCoreApplication.setApplicationName("Poursight")


class PatientBot(QtBot):
    """Waits as long as it takes, unless a test says how long."""

    def waitUntil(self, callback, *, timeout=1000 * HANG_S):
        super().waitUntil(callback, timeout=round(timeout))

    def waitSignal(self, signal, *, timeout=1000 * HANG_S, **options):
        return super().waitSignal(signal, timeout=round(timeout), **options)


@pytest.fixture
def qtbot(qapp, request):
    """pytest-qt's, but a patient one."""
    return PatientBot(request)


@pytest.fixture(scope="session", autouse=True)
def _no_real_settings(tmp_path_factory):
    """Nothing of the desktop's tests may touch the settings and the sessions of whoever runs them."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"):
        os.environ[name] = str(folder / name.lower())


@pytest.fixture(autouse=True)
def _garbage_is_collected_in_this_thread():
    """As the program does: a widget must not be destroyed in another thread than the one that made it."""
    gc.disable()
    yield
    gc.collect()


@pytest.fixture
def themed(qapp):
    """Sizes depend on the program's own style sheet."""
    from app.gui.theme import THEMES, apply_theme

    apply_theme(qapp, THEMES["light"])
    yield
    qapp.setStyleSheet("")


@pytest.fixture
def forgetful():
    """Nothing is remembered from another test."""
    from PySide6.QtCore import QSettings

    QSettings().clear()


@pytest.fixture
def window(qtbot, forgetful):
    """The whole window, shown, with the simulated cell; its processes end with the test."""
    from app.gui.desk.memory import Memory
    from app.gui.shell.window import MainWindow

    window = MainWindow(Memory())
    qtbot.addWidget(window)
    window.show()
    with qtbot.waitSignal(window.desk.cell.changed):
        window.desk.cell.restore()
    yield window
    window.close_without_asking()


@pytest.fixture
def desk(qtbot, forgetful):
    """A desk without a window; its processes start when a job needs them, and end with the test."""
    from app.gui.desk.desk import Desk

    desk = Desk()
    yield desk
    desk.close()
