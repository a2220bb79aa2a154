"""Sessions to look at, made once by the real pipeline with quick settings, and copied for each test."""

from __future__ import annotations

import shutil
from pathlib import Path

from app import commands
from app.jobs.session_work import SessionTask, working_on
from app.pouring import prepare
from app.scanning import scan_object
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.cell import SIMULATED_CELL, read_cell

QUICK = {
    "reconstruction.voxel_m": 0.004,
    "pouring.n_packings": 1,
    "containability.n_max": 150,
}


def quick_parameters() -> Parameters:
    """Coarser than the defaults, and with one packing."""
    return apply_settings(Parameters(), QUICK)


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
    commands.demo(name, folder, commands.Choices(None, [], None), None)
    return folder
