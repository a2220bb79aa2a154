"""One reference view at a board that stays where it is: each scan begins by taking it again and comparing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.around import calibrated_cell, looking, poses_around
from app.operations.calibration.capture import NOBODY, Capture, CaptureObserver, capturing_in, find_board
from app.operations.calibration.provenance import RESULT, latest_result, now, versions
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.drift import N_IMAGES, Drift, StillLook, measure_drift, still_look
from core.errors import InputError, MotionError, StageError
from core.files import reading, write_json
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import check_path
from core.progress import Reporter
from core.session import explained
from hardware.cell import Cell
from hardware.cell.calibrating import facing_board
from hardware.cell.scene import motion_scene, object_space
from hardware.cell.settings import CellSettings, ScanSettings


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
    calibrated = calibrated_cell(cell_file)
    with looking(
        calibrated, cell_file, step_names.REFERENCE, reporter, operator, laid, observer, 1
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
    cell: Cell, cell_file: Path, reporter: Reporter, operator: ScanOperator | None
) -> Drift | None:
    """Take the reference view again; warn if the camera has moved, refuse if it has moved far.

    Whatever stands on the platform is kept clear of: its size is not known yet.

    Args:
        cell: connected.
        cell_file: of it.
        reporter: receives the warning, and may cancel it.
        operator: confirms what a real arm does.

    Returns:
        by how much it moved; none if no look is stored.

    Raises:
        StageError: it moved so far that a scan would be worth nothing, or the board is not seen.
        MotionError: there is no clear way to where the look was taken.
        PoursightError: see `Capture.look_still`.
    """
    reference = read_reference(cell_file)
    if reference is None:
        return None
    settings, facts = cell.settings, {"board": asdict(reference.board)}
    there = replace(facing_board(cell, reference.board), scene=_scene_with_object(settings))
    with capturing_in(
        there, cell_file, reference.board, step_names.DRIFT, facts, reporter, operator, NOBODY, 1
    ) as capture:
        look = _look_again(capture, reference.joints_rad)
    drift = measure_drift(reference.look, look, reference.board, capture.lens)
    table = {"time": now(), "shift_m": drift.shift_m.tolist(), "turn_rad": drift.turn_rad.tolist()}
    with explained(capture.folder):
        write_json(capture.folder / RESULT, table | capture.facts | _look_table(look))
    judge_drift(drift, settings.scan, reporter)
    return drift


def _look_again(capture: Capture, joints_rad: FloatArray) -> StillLook:
    where = check_path(capture.cell.scene, joints_rad, capture.cell.settings.scan.min_clearance_m)
    if where.problem is not None:
        raise MotionError(
            f"The reference view was taken from where an object may stand ({where.problem}); store another "
            "one, or undo the reference of this cell."
        )
    try:
        return still_look(capture.look_still(joints_rad, N_IMAGES))
    except StageError as error:
        raise StageError(
            f"The board of the reference view is not seen as it was ({error}) Put it back and calibrate "
            "anew, or undo the reference of this cell."
        ) from error


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
    poses = poses_around(capture, 1, _scene_with_object(capture.cell.settings))
    if not poses:
        raise MotionError(
            "The arm reaches no place from which the board is seen well past an object on the platform; lay "
            "it elsewhere."
        )
    return poses[0].joints_rad


def _scene_with_object(settings: CellSettings) -> MotionScene:
    """What must not be touched when a scan begins: an object may fill all the space there is for one."""
    return motion_scene(settings, object_space(settings))


def _look_table(look: StillLook) -> dict[str, Any]:
    return {"ids": look.ids.tolist(), "corners_px": look.corners_px.tolist()}
