"""The records of a calibrated cell: every file that a step leaves, with looks that were made up."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from app.operations.calibration.around import calibrated_cell
from app.operations.calibration.devices import device_table
from app.operations.calibration.provenance import (
    RESULT,
    BoardEntry,
    calibration_folder,
    new_run,
    now,
    read_looks,
    runs,
    write_boards,
    write_looks,
)
from app.operations.calibration.reference import read_reference
from app.operations.calibration.steps import steps
from app.operations.calibration.undoing import undo
from app.operations.calibration.views import views_are_for
from core.calibration.board import BoardSpec
from core.calibration.collecting import Look
from core.calibration.noise import EXPECTED
from core.calibration.views import BoardView
from core.files import write_json
from core.geometry import FloatArray, look_at
from core.scan.model import Intrinsics
from hardware.cell import SIMULATED_CELL, read_cell
from tests.fuzz.mutation import damaged_json, replaced

_WITH_LOOKS = ("hand-eye", "check", "table")
_N_VIEWS, _N_CORNERS = 3, 6
_INTRINSICS = Intrinsics(530.0, 530.0, 320.0, 240.0)


def _make_calibration(cell: Path) -> None:
    """Write a cell's file and what its steps leave beside it."""
    shutil.copy(SIMULATED_CELL, cell)
    settings, board = read_cell(cell), BoardSpec()
    write_boards(cell, [BoardEntry(board, False, now()), BoardEntry(board, True, now())])
    place = settings.place.model_dump(mode="json", include={"platform_height_m", "crop_min_m"})
    views_rad = [list(row) for row in settings.scan.views_rad]
    results: dict[str, dict[str, Any]] = {
        "arm": {"said": "UR5", "problem": "", "device": device_table(settings, "arm")},
        "hand-eye": _hand_eye(settings.camera.pose, board),
        "check": {
            "n_views": 3, "hand_eye": "0001", "agreement": {"rms_m": 1e-3, "worst_m": 2e-3, "ratio": 1.0},
        },
        "table": {
            "hand_eye": "0001", "T_base_board": np.eye(4).tolist(), "center_m": [0.0, 0.0, 0.1],
            "tilt_rad": 0.001, "before": place, "after": place,
        },
        "reference": {
            "hand_eye": "0001", "joints_rad": [0.0] * 6, "ids": list(range(9)),
            "corners_px": [[10.0 * k, 5.0 * k] for k in range(9)], "board": asdict(board),
        },
        "drift": {"shift_m": [0.001, 0.0, 0.0], "turn_rad": [0.0, 0.001, 0.0]},
        "views": {
            "said": "24 views", "before": views_rad, "after": views_rad, "for": views_are_for(settings),
        },
    }  # fmt: skip
    for step, table in results.items():
        folder = new_run(cell, step)
        if step in _WITH_LOOKS:
            write_looks(folder, {"board": asdict(board)}, _looks(), None)
        write_json(folder / RESULT, {"time": now()} | table)


def _looks() -> list[Look]:
    joints = np.zeros(6)
    views = [
        BoardView(
            f"view {k}",
            look_at([0.3 * np.cos(k), 0.3 * np.sin(k), 0.5], [0, 0, 0]),
            np.arange(_N_CORNERS),
            np.full((_N_CORNERS, 2), 100.0) + 30 * np.arange(_N_CORNERS)[:, None] * [1, k],
            np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0, 1.0]]),
        )
        for k in range(_N_VIEWS)
    ]
    return [*(Look(joints, view) for view in views), Look(joints, None, "Nothing was seen.")]


def _hand_eye(T_flange_camera: FloatArray, board: BoardSpec) -> dict[str, Any]:
    return {
        "before": np.eye(4).tolist(),
        "after": T_flange_camera.tolist(),
        "T_base_board": np.eye(4).tolist(),
        "covariance": (1e-8 * np.eye(12)).tolist(),
        "degrees_of_freedom": 6.0,
        "noise": asdict(EXPECTED),
        "rms_px": 0.3,
        "weights": [1.0] * _N_VIEWS,
        "n_views": _N_VIEWS,
        "bounds": {"position_m": 3e-4, "angle_rad": 3e-4, "pouring_m": 3e-4},
        "held_out": {"position_m": 5e-4, "rms_px": 0.5, "ratio": 1.0},
        "board": asdict(board),
        "intrinsics": [530.0, 530.0, 320.0, 240.0],
        "size_px": [640, 480],
    }


def prepare_calibration(base: Path) -> None:
    """Write it into a folder."""
    _make_calibration(base / "cell.toml")


def damaged_calibration(base: Path, folder: Path, pick: Random) -> Iterator[Callable[[], object]]:
    """Damage one of the records, and yield what reads them."""
    shutil.copytree(base, folder, dirs_exist_ok=True)
    cell = folder / "cell.toml"
    path = pick.choice(sorted(calibration_folder(cell).rglob("*.json")))
    if not replaced(path, pick):
        path.write_bytes(damaged_json(path.read_bytes(), pick))
    yield lambda: steps(cell)
    yield lambda: calibrated_cell(cell).fit(_INTRINSICS)
    yield lambda: read_reference(cell)
    for step in _WITH_LOOKS:
        yield lambda step=step: [read_looks(run) for run in runs(cell, step)]
    yield lambda: undo(
        cell, pick.choice(("arm", "board", "hand-eye", "check", "table", "views", "reference"))
    )
