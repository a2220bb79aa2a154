"""The desktop's tests: widgets offscreen, those marked `gl` under Xvfb."""

from __future__ import annotations

import os

import pytest

pytest.importorskip("PySide6")
pytest.importorskip("pytestqt")

from PySide6.QtCore import QCoreApplication, Qt

QCoreApplication.setAttribute(
    Qt.ApplicationAttribute.AA_ShareOpenGLContexts
)  # before there is a QApplication
QCoreApplication.setOrganizationName("Poursight")
QCoreApplication.setApplicationName("Poursight")


@pytest.fixture(scope="session", autouse=True)
def _no_real_settings(tmp_path_factory):
    """Nothing of the desktop's tests may touch the settings and the sessions of whoever runs them."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"):
        os.environ[name] = str(folder / name.lower())


@pytest.fixture
def forgetful():
    """Nothing is remembered from another test."""
    from PySide6.QtCore import QSettings

    QSettings().clear()


@pytest.fixture
def window(qtbot, forgetful):
    """The whole window, shown, with the simulated cell; its processes end with the test."""
    from app.gui.desk.memory import Memory
    from app.gui.window import MainWindow

    window = MainWindow(Memory())
    qtbot.addWidget(window)
    window.show()
    with qtbot.waitSignal(window.desk.cell.changed, timeout=20_000):
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
