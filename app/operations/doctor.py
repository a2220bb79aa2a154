"""Is this installation able to do the job?"""

from __future__ import annotations

import platform
import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from app.library.places import cup_runs_folder
from core.imagination.kept_runs import MOST_BYTES, KeptRuns
from core.imagination.rendering.doctor import renderer_name
from hardware.cell import read_cell
from hardware.cell.examination import Finding, examine_cell

_FREE_DISK_BYTES = 2 * 10**9
_SHOWN = (
    "numpy",
    "numba",
    "scipy",
    "pybullet",
    "mujoco-core",
    "open3d-cpu",
    "opencv-python-headless",
    "trimesh",
    "vhacdx",
    "coacd",
    "pydantic",
)
_KNOWN_BAD = {
    ("PySide6-Essentials", "6.12.0"): "aborts after some thousand calls on Python 3.11; use 6.11.3",
    ("PySide6-Essentials", "6.11.0"): "is withdrawn by its users; use 6.11.3",
    ("PySide6-Essentials", "6.11.1"): "is withdrawn by its users; use 6.11.3",
}


def examine(cell_file: Path | None) -> Iterator[Finding]:
    """Find out about this installation, and about a cell's devices when its file is given.

    Raises:
        InputError: the cell file cannot be used.
    """
    for check in (_python, _packages, _known_bad, _renderer, _disk, _cup_runs):
        yield from check()
    if cell_file is not None:
        yield from examine_cell(read_cell(cell_file))


def _python() -> list[Finding]:
    fits = (3, 10) <= sys.version_info < (3, 12)
    problem = None if fits else "Python 3.10 or 3.11 is needed: PyBullet has no wheels for newer ones."
    return [Finding("python", f"{platform.python_version()} on {platform.platform()}", problem)]


def _packages() -> list[Finding]:
    findings = []
    for name in ("poursight", *_SHOWN):
        try:
            findings.append(Finding(name, version(name)))
        except PackageNotFoundError:
            findings.append(Finding(name, "missing", "Run 'make setup'."))
    return findings


def _known_bad() -> list[Finding]:
    findings = []
    for (name, bad), why in _KNOWN_BAD.items():
        try:
            installed = version(name)
        except PackageNotFoundError:
            continue
        if installed == bad:
            findings.append(Finding(name, installed, f"{name} {bad} {why}."))
    return findings


def _renderer() -> list[Finding]:
    return [Finding("renderer", renderer_name())]


def _disk() -> list[Finding]:
    free = shutil.disk_usage(Path.cwd()).free
    problem = (
        None if free > _FREE_DISK_BYTES else "Less than 2 GB are free here; free some space for sessions."
    )
    return [Finding("free disk", f"{free / 1e9:.1f} GB in {Path.cwd()}", problem)]


def _cup_runs() -> list[Finding]:
    kept = KeptRuns(cup_runs_folder())
    n_runs, n_bytes = kept.size()
    said = f"{n_runs}, {n_bytes / 1e6:.1f} of at most {MOST_BYTES / 1e6:.0f} MB in {kept.folder}"
    return [Finding("cup runs kept", said)]
