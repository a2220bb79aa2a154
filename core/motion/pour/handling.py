"""Is the cup taken, carried and laid as it should be: checked by forward kinematics on a plan's samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.geometry import grasp_of_cup
from core.motion.pour.plan import PlannedMove
from core.motion.pour.scene import PourScene
from core.parameters.imagination import PouringParameters

_PLACE_M = 0.001
_TILT_RAD = np.radians(0.1)
_UPRIGHT = ("lift", "carry", "carry back", "put down")
_TILTING = ("lay", "lower", "raise", "stand up")
_VERTICAL = ("lift", "lower", "raise", "put down")


def check_handling(
    scene: PourScene, pouring: PouringParameters, moves: Sequence[PlannedMove], T_grasp_cup: FloatArray
) -> None:
    """Verify that the cup is gripped where it stands, lifted straight, kept level and put back.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    psi = float(np.arctan2(T_grasp_cup[1, 0], T_grasp_cup[0, 0]))
    if not np.abs(T_grasp_cup - grasp_of_cup(psi, scene.cell.grip_height_m)).max() <= 1e-9:
        raise MotionError("The plan's cup does not sit in the hand as the cell says; plan the pour again.")
    for move in moves:
        if not move.holds_cup:
            continue
        cups = scene.held_cups(move.trajectory.joints_rad)
        if move.name in _UPRIGHT:
            _check_tilt(move, cups, scene.cell.limits.max_tilt_rad)
        elif move.name in _TILTING:
            _check_tilt(move, cups, np.pi / 2 - pouring.cup.slant_rad + _TILT_RAD)
        if move.name in _VERTICAL and not np.ptp(cups[:, :2, 3], axis=0).max() <= _PLACE_M:
            raise MotionError(f"In the move '{move.name}' the cup does not move straight up or down.")
    _check_place(scene, next(move for move in moves if move.name == "grasp"))
    _check_place(scene, next(move for move in moves if move.name == "put down"))


def tilts_rad(T_base_cup: FloatArray) -> FloatArray:
    """How far (N,) cups (N, 4, 4) lean."""
    return np.asarray(np.arccos(np.clip(T_base_cup[:, 2, 2], -1, 1)))


def _check_tilt(move: PlannedMove, cups: FloatArray, most_rad: float) -> None:
    tilt = float(tilts_rad(cups).max())
    if not tilt <= most_rad:
        raise MotionError(
            f"In the move '{move.name}' the cup leans by {np.degrees(tilt):.1f} degrees, where "
            f"{np.degrees(most_rad):.1f} are allowed."
        )


def _check_place(scene: PourScene, move: PlannedMove) -> None:
    cup = scene.held_cups(move.trajectory.joints_rad[-1:])
    beside = float(np.linalg.norm(cup[0, :3, 3] - scene.cell.cup_station_m))
    if not (beside <= _PLACE_M and tilts_rad(cup)[0] <= _TILT_RAD):
        raise MotionError(
            f"The move '{move.name}' ends {beside * 1000:.1f} mm beside the cup's station; plan the pour "
            "again."
        )
