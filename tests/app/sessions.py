"""Sessions to look at, made once by the real pipeline with quick settings, and copied for each test."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock

from app.cli import session_commands
from app.cli.parameters import NOTHING_CHOSEN
from app.operations.pouring import prepare
from app.operations.scanning import scan_object
from app.operations.session import SessionTask, working_on
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.cell import SIMULATED_CELL, read_cell

QUICK = {
    "reconstruction.voxel_m": 0.004,
    "containability.n_max": 150,
    "capacity.n_fillings": 1,
    "capacity.n_aimed": 20,
    "capacity.lattice_points": 100_000,
    "holding.n_load": 6,
    "holding.tilt_step_rad": 0.2,
    "risk.n_tries": 4,
    "pouring.n_pour": 20,
}


def quick_parameters() -> Parameters:
    """Coarser than the defaults, and with fewer candies."""
    return apply_settings(Parameters(), QUICK)


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder that is made once for all processes of a test run; it is to be copied, not changed."""
    base = factory.getbasetemp()
    root = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, is_made = root / "made" / name, root / f"{name}.made"
    with FileLock(root / f"{name}.lock"):
        if not is_made.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.parent.mkdir(exist_ok=True)
            make(folder)
            is_made.touch()
    return folder


def make_session(folder: Path, name: str) -> Path:
    """Scan a built-in object in the simulated cell, imagine it, and judge the arm's motions for its pours."""
    reporter = Reporter()
    with WorkerPool() as pool:
        task = SessionTask(folder, quick_parameters(), "default")
        with working_on(task, pool, reporter) as pipeline:
            scan_object(pipeline, read_cell(SIMULATED_CELL), name)
            pipeline.quality()
            if pipeline.imagination().choice is not None:
                prepare(pipeline, read_cell(SIMULATED_CELL))
    return folder


def copied(made: Path, folder: Path) -> Path:
    """Return a copy that a test may change."""
    return Path(shutil.copytree(made, folder))


def make_poured_session(folder: Path, name: str) -> Path:
    """Scan, imagine, pour in the simulated cell, and render the evidence, all with the defaults."""
    session_commands.demo(name, folder, NOTHING_CHOSEN, None)
    return folder
