"""Checking a calibrated cell: the board, moved, must be at one and the same place from all sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration.capture import LookTaken, capturing, find_board
from app.operations.calibration.hand_eye import entered_board, is_same
from app.operations.calibration.provenance import (
    CHECK,
    HAND_EYE,
    RESULT,
    latest_result,
    now,
    read_looks,
    versions,
    withdraw,
)
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.checking import FEWEST_VIEWS, Agreement, check_agreement
from core.calibration.hand_eye import HandEyeFit
from core.calibration.noise import Noise, pose_errors
from core.calibration.proposing import ProposalTask, in_short_order, propose_poses
from core.calibration.rig import Rig, all_derivatives
from core.errors import InputError, StageError
from core.files import reading, write_json
from core.progress import Reporter
from core.scan.model import Intrinsics
from core.session import explained
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell import Cell, read_cell

N_VIEWS = 6
_MARGIN_PX = 25.0
_SIMULATED_MOVE_M, _SIMULATED_TURN_RAD = np.array([-0.05, 0.04, 0.0]), 2.2


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
    taken: LookTaken = lambda look, n_usable: None,  # noqa: ARG005
) -> Check:
    """Look at the board in another place, and compare; the cell's file is not changed.

    Args:
        cell_file: of the cell.
        reporter: may cancel.
        operator: confirms what a real arm does.
        moved: called when the board is to be moved by a person; raises `Cancelled` if it will not be.
        taken: called with each look.

    Raises:
        PoursightError: the sentence says what is in the way, or that the calibration does not hold.
    """
    settings, board = read_cell(cell_file), entered_board(cell_file)
    latest = latest_result(cell_file, HAND_EYE)
    if latest is None or not is_same(latest[1]["after"], settings.camera.pose):
        raise InputError(
            f"The hand-eye pose in {cell_file} is not one that was calibrated here; calibrate first."
        )
    calibrated, table = latest
    facts: dict[str, Any] = {"board": asdict(board), "hand_eye": calibrated.name}
    if not settings.has_simulated_object:
        moved()
    with capturing(cell_file, settings, board, CHECK, facts, reporter, operator, taken, N_VIEWS) as capture:
        if settings.has_simulated_object:
            _move_simulated(capture.cell)
        find_board(capture)
        first = next(look.view for look in capture.collection.looks if look.view is not None)
        T_base_board = first.T_base_flange @ settings.camera.pose @ first.T_camera_board
        rig = Rig(settings.camera.pose, T_base_board, capture.collection.intrinsics)
        task = ProposalTask(
            rig, board, capture.collection.image_size_px, capture.collection.home_rad, _MARGIN_PX,
            settings.camera.min_range_m,
        )  # fmt: skip
        here = np.array(capture.cell.robot.state().joints_rad)
        capture.go_and_look(in_short_order(propose_poses(capture.cell.scene, task, N_VIEWS), here))
    views = capture.collection.views
    if len(views) < FEWEST_VIEWS:
        raise StageError(
            f"Only {len(views)} views of the board could be used; see that the arm can go around it, "
            "and check again."
        )
    fit = _calibrated(calibrated, table, board, capture.collection.intrinsics)
    found = Check(capture.folder, len(views), check_agreement(fit, views, board))
    result = {"time": now(), "n_views": found.n_views, "agreement": asdict(found.agreement)}
    with explained(found.folder):
        write_json(found.folder / RESULT, result | capture.facts | {"versions": versions()})
    return found


def undo_check(cell_file: Path) -> None:
    """Let the newest check count no more; what was taken is kept.

    Raises:
        InputError: there is none.
    """
    latest = latest_result(cell_file, CHECK)
    if latest is None:
        raise InputError(f"No check of {cell_file} can be undone; there is none.")
    withdraw(latest[0])


def _move_simulated(cell: Cell) -> None:
    camera = cell.camera
    assert isinstance(camera, SimulatedBoardCamera), "a simulated cell that looks at its board"
    middle_m = cell.settings.place.platform_center_m + _SIMULATED_MOVE_M
    middle_m[2] += 0.004
    camera.T_base_board = camera.lying(middle_m, _SIMULATED_TURN_RAD)


def _calibrated(folder: Path, table: dict[str, Any], board: BoardSpec, intrinsics: Intrinsics) -> HandEyeFit:
    """The fit as its record has it."""
    _, looks = read_looks(folder)
    views = [look.view for look in looks if look.view is not None and look.is_used]
    with reading(folder / RESULT):
        rig = Rig(table["after"], table["T_base_board"], intrinsics)
        return HandEyeFit(
            rig=rig,
            covariance=np.array(table["covariance"]),
            degrees_of_freedom=float(table["degrees_of_freedom"]),
            noise=Noise(**table["noise"]),
            poses=pose_errors(all_derivatives(rig, board, views)),
            weights=np.array(table["weights"]),
            rms_px=float(table["rms_px"]),
        )
