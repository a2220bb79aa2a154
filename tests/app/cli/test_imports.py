"""The command line is light: `--help` waits for nothing that a window or the physics needs."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import version

HEAVY = (
    *("PySide6", "pyqtgraph", "pybullet", "open3d", "trimesh", "matplotlib", "numba", "optuna"),
    "rtde_control",
)


def test_the_command_line_imports_nothing_heavy():
    program = f"import sys, app.cli; print([name for name in {HEAVY!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_without_a_screen_the_desktop_says_so(monkeypatch, poursight):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("app.gui.main.QApplication.instance", lambda: None)
    code, _, err = poursight()
    assert code == 1
    assert "There is no screen" in err
    assert "poursight demo" in err


def test_the_version_is_that_of_the_package(poursight):
    code, out, _ = poursight("--version")
    assert (code, out) == (0, f"Poursight {version('poursight')}\n")
