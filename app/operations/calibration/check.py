"""Checking a calibrated cell: the board, moved, must be at one and the same place from all sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.around import (
    N_VIEWS,
    calibrated_cell,
    lay_simulated_board,
    look_around,
    looking,
)
from app.operations.calibration.capture import NOBODY, CaptureObserver
from app.operations.calibration.provenance import RESULT, now, versions
from app.operations.scan_run import ScanOperator
from core.calibration.checking import Agreement, check_agreement, locate_board
from core.files import write_json
from core.geometry import FloatArray
from core.progress import Reporter
from core.session import explained
from hardware.cell.settings import CellSettings

_SIMULATED_MOVE_M, _SIMULATED_TURN_RAD = np.array([-0.05, 0.04, 0.004]), 2.2


@dataclass(frozen=True)
class Check:
    """What came of a check.

    Attributes:
        folder: with its views and its result.
        n_views: that were compared.
        agreement: how well they agree.
    """

    folder: Path
    n_views: int
    agreement: Agreement


def check_cell(
    cell_file: Path,
    reporter: Reporter,
    operator: ScanOperator | None,
    moved: Callable[[], None],
    observer: CaptureObserver = NOBODY,
) -> Check:
    """Look at the board in another place, and compare; the cell's file is not changed.

    Args:
        cell_file: of the cell.
        reporter: may cancel.
        operator: confirms what a real arm does.
        moved: called when the board is to be moved by a person; raises `Cancelled` if it will not be.
        observer: of whoever follows it.

    Raises:
        PoursightError: the sentence says what is in the way.
    """
    calibrated = calibrated_cell(cell_file)
    settings, board = calibrated.settings, calibrated.board
    with looking(
        calibrated, cell_file, step_names.CHECK, reporter, operator, moved, observer, N_VIEWS
    ) as capture:
        if settings.has_simulated_object:
            lay_simulated_board(capture.cell, *simulated_place(settings))
        views = look_around(capture)
    fit = calibrated.fit(capture.collection.intrinsics)
    found = Check(capture.folder, len(views), check_agreement(fit, views, board))
    T_base_board, _ = locate_board(fit, views, board)
    result = {
        "time": now(),
        "n_views": found.n_views,
        "agreement": asdict(found.agreement),
        "T_base_board": T_base_board.tolist(),
    }
    with explained(found.folder):
        write_json(found.folder / RESULT, result | capture.facts | {"versions": versions()})
    return found


def simulated_place(settings: CellSettings) -> tuple[FloatArray, float]:
    """Return where a simulated board is laid for a check: its middle (3,) and its turn about the vertical."""
    return settings.place.platform_center_m + _SIMULATED_MOVE_M, _SIMULATED_TURN_RAD
