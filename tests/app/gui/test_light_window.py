"""The window's process imports nothing that computes: such libraries hold up every thread while they load."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import app.gui

HEAVY = (
    "numba",
    "llvmlite",
    "pybullet",
    "open3d",
    "trimesh",
    "scipy",
    "cv2",
    "optuna",
    "rtde_control",
    "core.reconstruction.tsdf",
)
OWN = ("app", "core", "hardware")


def imported_at_any_time() -> set[str]:
    """What the code of `app.gui` names, in functions as well."""
    names: set[str] = set()
    for path in Path(app.gui.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                names.add(node.module)
            elif isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
    return {name for name in names if name.partition(".")[0] in OWN}


def test_whatever_the_window_imports_computes_nothing():
    names = sorted(imported_at_any_time())
    assert len(names) > 100
    program = (
        f"import sys, importlib; [importlib.import_module(name) for name in {names!r}]; "
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_sources_that_were_looked_into_while_pages_were_imported_are_not_kept():
    program = "import linecache, app.gui.shell.window as w; w.Preload().run(); print(len(linecache.cache))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "0"
