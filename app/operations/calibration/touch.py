"""A touch check: the hand is guided until its tip is on a corner of the board that was checked last."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.around import CalibratedCell, calibrated_cell
from app.operations.calibration.check import simulated_place
from app.operations.calibration.provenance import latest_result, now
from core.calibration.detection import with_square
from core.calibration.touching import Touch, touched_corner
from core.errors import InputError
from core.files import read_json, reading, write_json
from core.geometry import FloatArray, transform_points
from core.motion.kinematics import flange_pose
from core.session import explained
from hardware.cell import CellSettings
from hardware.cell.calibrating import simulated_set_up
from hardware.cell.own_arm import guided_joints_rad, own_kinematics
from hardware.cell.settings import ARMS
from hardware.simulation.board_view import lying_board
from hardware.simulation.touching import joints_on_point

TOUCHES = "touches.json"
FARTHEST_TIP_M = 0.5
_STREAM = 5


@dataclass(frozen=True, eq=False)
class Touched:
    """What came of a touch.

    Attributes:
        touch: which corner, and how far beside it.
        expected_m: what the calibration states with 95 % at the place of pouring.
    """

    touch: Touch
    expected_m: float


def read_touch(cell_file: Path, tip_m: FloatArray | None = None) -> Touched:
    """Read where the tip is, which touches a corner; nothing moves, and the cell's file is not changed.

    A later touch of the same corner takes the place of an earlier one.

    Args:
        cell_file: of the cell.
        tip_m: (3,) the tip in the flange frame; none: as touched with last, else the middle of the grip.

    Raises:
        InputError: the cell was not checked since it was calibrated, or no tip is where it is said to be.
        StageError: no corner is near enough to tell which one is touched.
        RobotError: the controller does not answer, or the arm moves.
        SessionError: a record is damaged, or the disk refuses.
    """
    calibrated = calibrated_cell(cell_file)
    folder, T_base_board = _checked(cell_file, calibrated)
    touches = read_touches(folder)
    settings = calibrated.settings
    tip = usual_tip_m(settings, touches) if tip_m is None else np.asarray(tip_m, dtype=float)
    if not np.linalg.norm(tip) <= FARTHEST_TIP_M:
        raise InputError(
            f"A tip is at most {1000 * FARTHEST_TIP_M:.0f} mm from the flange; measure where it is, in the "
            "flange frame."
        )
    if settings.robot.is_real:
        joints_rad = guided_joints_rad(settings)
    else:
        joints_rad = _guided_in_simulation(calibrated, tip, len(touches))
    T_base_flange = flange_pose(own_kinematics(settings).model, joints_rad)
    touch = touched_corner(T_base_flange, tip, T_base_board, calibrated.board)
    entry = {
        "time": now(), "corner": touch.corner, "off_m": touch.off_m.tolist(),
        "tip_m": tip.tolist(), "joints_rad": joints_rad.tolist(),
    }  # fmt: skip
    kept = [other for other in touches if other["corner"] != touch.corner]
    with explained(folder):
        write_json(folder / TOUCHES, {"touches": [*kept, entry]})
    with reading(calibrated.folder):
        return Touched(touch, float(calibrated.table["bounds"]["pouring_m"]))


def read_touches(folder: Path) -> list[dict[str, Any]]:
    """Return the touches that belong to a check, each of another corner.

    Raises:
        SessionError: the file is damaged.
    """
    path = folder / TOUCHES
    if not path.is_file():
        return []
    table = read_json(path, None)
    with reading(path):
        touches: list[dict[str, Any]] = list(table["touches"])
        for touch in touches:
            for name in ("off_m", "tip_m"):
                if np.array(touch[name], dtype=float).shape != (3,):
                    raise ValueError(f"{name} is no point")
            int(touch["corner"])
        return touches


def usual_tip_m(settings: CellSettings, touches: list[dict[str, Any]]) -> FloatArray:
    """Return the tip (3,) in the flange frame, as it was touched with last, else the middle of the grip."""
    return np.array(touches[-1]["tip_m"] if touches else settings.gripper.grasp_pose[:3, 3], dtype=float)


def _checked(cell_file: Path, calibrated: CalibratedCell) -> tuple[Path, FloatArray]:
    """The last check of the present calibration, and where it found the board."""
    latest = latest_result(cell_file, step_names.CHECK)
    if latest is not None and latest[1].get("hand_eye") == calibrated.folder.name:
        folder, table = latest
        _refuse_moved(cell_file, str(table["time"]))
        if "T_base_board" in table:
            with reading(folder):
                return folder, np.array(table["T_base_board"], dtype=float).reshape(4, 4)
    raise InputError(
        f"Where the board lies was not seen since {cell_file} was calibrated; do the step 'check' first, and "
        "leave the board where it is."
    )


def _refuse_moved(cell_file: Path, checked: str) -> None:
    """Refuse a board that was laid elsewhere for another step since that time (ISO 8601, UTC)."""
    for step in (step_names.TABLE, step_names.REFERENCE):
        later = latest_result(cell_file, step)
        if later is not None and str(later[1].get("time", "")) > checked:
            raise InputError(
                f"The board was laid elsewhere for the step '{step}' since it was checked; do the "
                "step 'check' again, and touch it then."
            )


def _guided_in_simulation(calibrated: CalibratedCell, tip_m: FloatArray, n_before: int) -> FloatArray:
    """Somebody puts the tip of a simulated arm onto a corner of the board, where that really is."""
    settings = calibrated.settings
    set_up = simulated_set_up(settings)
    board = with_square(calibrated.board, set_up.square_m)
    order = np.random.default_rng([set_up.seed, _STREAM]).permutation(board.n_corners)
    corner = int(order[n_before % board.n_corners])
    point_m = transform_points(lying_board(board, *simulated_place(settings)), board.corners_m[corner])
    random = np.random.default_rng([set_up.seed, _STREAM, corner])
    return joints_on_point(ARMS[settings.robot.model], set_up, tip_m, point_m, random)
