"""Calibrating where a cell's camera hangs: look, fit, judge, and put the result into the cell's file."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.capture import (
    NOBODY,
    Capture,
    CaptureObserver,
    capturing,
    find_board,
    take_rounds,
)
from app.operations.calibration.cell_file import arm_table, write_hand_eye
from app.operations.calibration.provenance import (
    RESULT,
    discard_run,
    interrupted_run,
    now,
    read_boards,
    read_looks,
    versions,
)
from app.operations.scan_run import ScanOperator
from core.calibration.accuracy import Bounds, HeldOut, bounds, hold_out
from core.calibration.board import BoardSpec
from core.calibration.collecting import Look
from core.calibration.diversity import diversity
from core.calibration.hand_eye import HandEyeFit, calibrate_hand_eye
from core.calibration.noise import EXPECTED
from core.calibration.proposing import USUAL_VIEWS
from core.calibration.rig import log_pose
from core.calibration.view_set import why_too_little, why_wrong
from core.errors import InputError, Remedy, StageError
from core.files import write_json
from core.geometry import FloatArray, invert_pose
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from core.session import explained
from hardware.cell.reading import read_cell
from hardware.cell.settings import CellSettings

MOST_POURING_M = 0.003
"""A constant error of 3 mm and 1 degree survives reconstruction, one of 5 mm and 2 degrees does not."""
MOST_RATIO = 2.0
SAME_POSE = 1e-6
_DEVICES = {"kinematics": "arm", "intrinsics": "camera"}
"""What tells one device from another, in the facts that are kept with the looks."""


@dataclass(frozen=True)
class Calibration:
    """A hand-eye calibration that was accepted, and what it is worth.

    Attributes:
        folder: with its views and its result.
        n_views: used by the fit.
        n_refused: looks that were not used.
        bounds: what the error stays below in 95 of 100.
        held_out: how well unseen views are foretold.
        diversity: a sentence on the rotations.
        moved_m: how far the camera's place is from where the file had it.
        moved_rad: by what angle.
    """

    folder: Path
    n_views: int
    n_refused: int
    bounds: Bounds
    held_out: HeldOut
    diversity: str
    moved_m: float
    moved_rad: float


def calibrate_cell(
    cell_file: Path,
    reporter: Reporter,
    operator: ScanOperator | None,
    observer: CaptureObserver = NOBODY,
    n_views: int = USUAL_VIEWS,
    is_restarted: bool = False,
) -> Calibration:
    """Calibrate, continuing an interrupted run with the same board; the file changes only if it is accepted.

    Args:
        cell_file: of the cell.
        reporter: may cancel.
        operator: confirms what a real arm does; without one nothing real moves.
        observer: of whoever follows it.
        n_views: wanted.
        is_restarted: whether the looks of an interrupted run are left aside.

    Raises:
        PoursightError: the sentence says what is in the way; looks that were taken are kept.
    """
    settings = read_cell(cell_file)
    board = entered_board(cell_file)
    facts: dict[str, Any] = {"board": asdict(board), "T_flange_camera": settings.camera.pose.tolist()}
    before = None if is_restarted else _interrupted(cell_file, facts)
    with capturing(
        cell_file,
        _of_any_arm(settings),
        board,
        step_names.HAND_EYE,
        facts,
        reporter,
        operator,
        observer,
        n_views,
    ) as capture:
        if before is not None:
            known, looks = before
            try:
                _refuse_other_devices(known, capture.facts)
            except StageError:
                discard_run(capture.folder)
                raise
            capture.adopt(looks)
        if not any(look.view is not None for look in capture.collection.looks):
            find_board(capture)
        take_rounds(capture)
    return conclude(cell_file, settings, capture)


def _of_any_arm(settings: CellSettings) -> CellSettings:
    """It is being calibrated: with which arm it was before does not matter."""
    return settings.model_copy(
        update={
            "robot": settings.robot.model_copy(update={"kinematics_checksum": None, "own_kinematics": None})
        }
    )


def conclude(cell_file: Path, settings: CellSettings, capture: Capture) -> Calibration:
    """Fit, judge and, if it is good, write the result and the cell's file.

    Raises:
        StageError: the views do not suffice or contradict each other, or the result is not good enough.
    """
    views, board = capture.collection.views, capture.collection.board
    problem = why_too_little(views, settings.camera.pose)
    if problem is not None:
        raise StageError(problem)
    fit = calibrate_hand_eye(views, board, capture.collection.intrinsics)
    problem = why_wrong(fit, views, board)
    if problem is not None:
        raise StageError(problem, Remedy.RESTART_CALIBRATION)
    kinematics = capture.cell.robot.kinematics
    scan = flange_pose(kinematics.model, np.array(settings.scan.views_rad))
    stated = bounds(fit, scan, settings.place.platform_center_m)
    held_out = hold_out(fit, views, board)
    rotations = diversity([view.T_base_flange for view in views], fit.T_flange_camera)
    _refuse_poor(stated, held_out, rotations.sentence)
    change = log_pose(invert_pose(settings.camera.pose) @ fit.T_flange_camera)
    found = Calibration(
        capture.folder, len(views), len(capture.collection.looks) - len(views), stated, held_out,
        rotations.sentence, float(np.linalg.norm(change[3:])), float(np.linalg.norm(change[:3])),
    )  # fmt: skip
    table = _result_table(found, fit, settings, board) | capture.facts
    with explained(capture.folder):
        write_json(capture.folder / RESULT, table)
    write_hand_eye(cell_file, fit.T_flange_camera, kinematics)
    return found


def is_same(T_first: FloatArray, T_second: FloatArray) -> bool:
    """Whether two poses (4, 4) are the same but for the digits in a file."""
    return bool(np.abs(T_first - T_second).max() < SAME_POSE)


def entered_board(cell_file: Path) -> BoardSpec:
    """Return the cell's board, whose squares were measured.

    Raises:
        InputError: none was entered, or its squares were not measured.
    """
    entries = read_boards(cell_file)
    if not entries:
        raise InputError(f"No calibration board is entered for {cell_file}; print and measure one first.")
    if not entries[-1].is_measured:
        raise InputError(
            f"The squares of the board of {cell_file} were not measured on the print; measure and enter them."
        )
    return entries[-1].board


def _interrupted(cell_file: Path, facts: dict[str, Any]) -> tuple[dict[str, Any], list[Look]] | None:
    """Facts and looks of the newest run, if it did not come to a result and was about the same."""
    folder = interrupted_run(cell_file, step_names.HAND_EYE)
    if folder is None:
        return None
    known, looks = read_looks(folder)
    is_same_run = all(known.get(name) == value for name, value in facts.items())
    return (known, looks) if is_same_run else None


def _refuse_other_devices(known: dict[str, Any], facts: dict[str, Any]) -> None:
    """Looks by another arm or through another camera say nothing of where this one hangs at that one."""
    for name, device in _DEVICES.items():
        before = known.get(name, facts[name])
        if before != facts[name]:
            raise StageError(
                f"What an interrupted calibration saw is of another {device} than is connected now ({name} "
                f"{before or 'not known'}, now {facts[name] or 'not known'}); connect that one again, or "
                "begin anew.",
                Remedy.RESTART_CALIBRATION,
            )


def _refuse_poor(stated: Bounds, held_out: HeldOut, rotations: str) -> None:
    if stated.pouring_m > MOST_POURING_M:
        raise StageError(
            f"At the place of pouring this calibration is only good to {stated.pouring_m * 1000:.1f} mm, and "
            f"{MOST_POURING_M * 1000:.0f} mm are needed; take more views. {rotations}"
        )
    if held_out.ratio > MOST_RATIO:
        raise StageError(
            f"Views that the fit did not see are {held_out.ratio:.1f} times as far off as they should be "
            f"({held_out.position_m * 1000:.1f} mm); fix board and camera, and take the views anew.",
            Remedy.RESTART_CALIBRATION,
        )


def _result_table(
    found: Calibration, fit: HandEyeFit, before: CellSettings, board: BoardSpec
) -> dict[str, Any]:
    noise = fit.noise
    return {
        "time": now(),
        "before": before.camera.pose.tolist(),
        "arm_before": arm_table(before),
        "after": fit.T_flange_camera.tolist(),
        "T_base_board": fit.rig.T_base_board.tolist(),
        "covariance": fit.covariance.tolist(),
        "degrees_of_freedom": fit.degrees_of_freedom,
        "noise": asdict(noise),
        "expected_noise": asdict(EXPECTED),
        "rms_px": fit.rms_px,
        "weights": fit.weights.tolist(),
        "n_views": found.n_views,
        "n_refused": found.n_refused,
        "bounds": asdict(found.bounds),
        "held_out": asdict(found.held_out),
        "diversity": found.diversity,
        "moved_m": found.moved_m,
        "moved_rad": found.moved_rad,
        "board": asdict(board),
        "versions": versions(),
    }
