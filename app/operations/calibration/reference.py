"""One reference view at a board that stays where it is: each scan begins by taking it again and comparing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.around import calibrated_run, poses_around
from app.operations.calibration.capture import NOBODY, Capture, CaptureObserver, capturing, find_board
from app.operations.calibration.hand_eye import entered_board
from app.operations.calibration.provenance import RESULT, latest_result, now, versions
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.drift import N_IMAGES, Drift, StillLook, measure_drift, still_look
from core.errors import InputError, MotionError, StageError
from core.files import reading, write_json
from core.geometry import FloatArray
from core.progress import Reporter
from core.session import explained
from hardware.cell import read_cell
from hardware.cell.settings import ScanSettings


@dataclass(frozen=True)
class Reference:
    """A look that was stored.

    Attributes:
        joints_rad: (6,) from where.
        look: what was seen.
        board: that was seen.
    """

    joints_rad: FloatArray
    look: StillLook
    board: BoardSpec


def store_reference(
    cell_file: Path,
    reporter: Reporter,
    operator: ScanOperator | None,
    laid: Callable[[], None],
    observer: CaptureObserver = NOBODY,
) -> Path:
    """Look at the board where it shall stay, from the side that tells most; return the run's folder.

    Args:
        cell_file: of the cell, calibrated.
        reporter: may cancel.
        operator: confirms what a real arm does.
        laid: called when a person has to fix the board where it stays; raises `Cancelled` if it is not done.
        observer: of whoever follows it.

    Raises:
        PoursightError: the sentence says what is in the way.
    """
    settings, board = read_cell(cell_file), entered_board(cell_file)
    calibrated, _ = calibrated_run(cell_file, settings)
    facts: dict[str, Any] = {"board": asdict(board), "hand_eye": calibrated.name}
    if not settings.has_simulated_object:
        laid()
    with capturing(
        cell_file, settings, board, step_names.REFERENCE, facts, reporter, operator, observer, 1
    ) as capture:
        find_board(capture)
        joints = _best_pose(capture)
        look = still_look(capture.look_still(joints, N_IMAGES))
    result = {"time": now(), "joints_rad": joints.tolist(), **_look_table(look)}
    with explained(capture.folder):
        write_json(capture.folder / RESULT, result | capture.facts | {"versions": versions()})
    return capture.folder


def read_reference(cell_file: Path) -> Reference | None:
    """Return the reference view; none if there is none, or if the camera was calibrated anew since.

    Raises:
        SessionError: the record is damaged.
    """
    latest = latest_result(cell_file, step_names.REFERENCE)
    if latest is None:
        return None
    folder, table = latest
    with reading(folder / RESULT):
        try:
            board = BoardSpec(**table["board"])
        except InputError as error:
            raise ValueError(str(error)) from error
        ids = np.array(table["ids"], dtype=np.int64)
        corners, joints = (
            np.array(table["corners_px"], dtype=float),
            np.array(table["joints_rad"], dtype=float),
        )
        if corners.shape != (len(ids), 2) or joints.shape != (6,):
            raise ValueError("corners or joints are of another shape")
        if len(ids) and (ids.min() < 0 or ids.max() >= board.n_corners or (np.diff(ids) <= 0).any()):
            raise ValueError("there are no such corners")
        return Reference(joints, StillLook(ids, corners), board)


def check_drift(
    cell_file: Path, reporter: Reporter, operator: ScanOperator | None, observer: CaptureObserver = NOBODY
) -> Drift | None:
    """Take the reference view again; warn if the camera has moved, refuse if it has moved far.

    Args:
        cell_file: of the cell.
        reporter: receives the warning, and may cancel it.
        operator: confirms what a real arm does.
        observer: of whoever follows it.

    Returns:
        by how much it moved; none if no look is stored.

    Raises:
        StageError: it moved so far that a scan would be worth nothing, or the board is not seen.
        PoursightError: see `Capture.look_still`.
    """
    reference = read_reference(cell_file)
    if reference is None:
        return None
    settings, facts = read_cell(cell_file), {"board": asdict(reference.board)}
    with capturing(
        cell_file, settings, reference.board, step_names.DRIFT, facts, reporter, operator, observer, 1
    ) as capture:
        try:
            look = still_look(capture.look_still(reference.joints_rad, N_IMAGES))
        except StageError as error:
            raise StageError(
                f"The board of the reference view is not seen as it was ({error}) Put it back and calibrate "
                "anew, or undo the reference of this cell."
            ) from error
    drift = measure_drift(reference.look, look, reference.board, capture.lens)
    table = {"time": now(), "shift_m": drift.shift_m.tolist(), "turn_rad": drift.turn_rad.tolist()}
    with explained(capture.folder):
        write_json(capture.folder / RESULT, table | capture.facts | _look_table(look))
    judge_drift(drift, settings.scan, reporter)
    return drift


def judge_drift(drift: Drift, limits: ScanSettings, reporter: Reporter) -> None:
    """Warn or refuse.

    Raises:
        StageError: it is more than the most that is allowed.
    """
    said = f"Since the calibration the camera has moved against its board by {drift.sentence}"
    if drift.position_m > limits.most_drift_m or drift.angle_rad > limits.most_drift_rad:
        raise StageError(
            f"{said}. A scan would be worth nothing: see what is loose at camera, arm and board, fix it, "
            "calibrate anew, and store the reference view again."
        )
    if drift.position_m > limits.drift_m or drift.angle_rad > limits.drift_rad:
        reporter.warn(
            f"{said}; see whether camera or board are loose, and calibrate anew before a pour has to be "
            "exact."
        )


def _best_pose(capture: Capture) -> FloatArray:
    poses = poses_around(capture, 1)
    if not poses:
        raise MotionError("The arm reaches no place from which the board is seen well; lay it elsewhere.")
    return poses[0].joints_rad


def _look_table(look: StillLook) -> dict[str, Any]:
    return {"ids": look.ids.tolist(), "corners_px": look.corners_px.tolist()}
