"""Is the pour the one that was imagined: checked by forward kinematics on a plan's samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, rotation_z
from core.imagination.cup import cup_pose, pivot_in_cup_m, pour_angle
from core.motion.pour.building import imagined_rate
from core.motion.pour.plan import PlannedMove
from core.motion.pour.scene import PourScene
from core.motion.trajectory import SAMPLE_S
from core.parameters.imagination import PouringParameters

_ANGLE_RAD = 1e-4
_RATE_SHARE = 1e-3
_RATE_RAD_S = 1e-3


def check_turn(
    scene: PourScene,
    pouring: PouringParameters,
    moves: Sequence[PlannedMove],
    T_grasp_cup: FloatArray,
    pivot_m: FloatArray,
    theta_rad: float,
) -> tuple[float, float]:
    """Verify the turn about the pivot, there and back; return the pivot's error and the time of the turn.

    The cup turns about l_pour (Sec. III-B) and about nothing else, from gamma = 0 to gamma_0; it stands
    still before and after for at least the imagined times, and is never ahead of the imagined turn nor
    faster than that is at the same angle.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    there = next(move for move in moves if move.name == "pour")
    back = next(move for move in moves if move.name == "turn back")
    tolerance = scene.cell.limits.pivot_tolerance_m
    worst = 0.0
    gammas = {}
    for move in (there, back):
        cups = scene.grasp_poses(move.trajectory.joints_rad) @ T_grasp_cup
        error, gammas[move.name] = _turned(pouring, move, cups, pivot_m, theta_rad)
        if not error <= tolerance:
            raise MotionError(
                f"In the move '{move.name}' the pivot wanders by {error * 1000:.2f} mm, where "
                f"{tolerance * 1000:.2f} mm are allowed."
            )
        worst = max(worst, error)
    _check_ends(pouring, gammas["turn back"][::-1], back)
    _check_ends(pouring, gammas["pour"], there)
    return worst, _check_profile(pouring, gammas["pour"], there)


def _turned(
    pouring: PouringParameters, move: PlannedMove, cups: FloatArray, pivot_m: FloatArray, theta_rad: float
) -> tuple[float, FloatArray]:
    """How far the pivot wanders, and gamma (N,); refuses any other turning."""
    ready = cup_pose(pouring.cup, pivot_m, theta_rad, 0.0)[:3, :3]
    turned = np.swapaxes(rotation_z(theta_rad).T @ cups[:, :3, :3] @ ready.T @ rotation_z(theta_rad), 1, 2)
    gamma: FloatArray = np.arctan2(turned[:, 0, 2], turned[:, 0, 0])
    ideal = np.zeros_like(turned)
    ideal[:, 1, 1] = 1
    ideal[:, 0, 0] = ideal[:, 2, 2] = np.cos(gamma)
    ideal[:, 0, 2], ideal[:, 2, 0] = np.sin(gamma), -np.sin(gamma)
    if not np.abs(turned - ideal).max() <= _ANGLE_RAD:
        raise MotionError(f"In the move '{move.name}' the cup does not turn about the pour's axis alone.")
    pivots = cups[:, :3, :3] @ pivot_in_cup_m(pouring.cup) + cups[:, :3, 3]
    return float(np.linalg.norm(pivots - pivot_m, axis=1).max()), gamma


def _check_ends(pouring: PouringParameters, gamma: FloatArray, move: PlannedMove) -> None:
    ends = gamma[0], gamma[-1] - pouring.gamma_0_rad
    if not np.abs(ends).max() <= _ANGLE_RAD:
        raise MotionError(f"The move '{move.name}' does not turn the cup by the whole imagined angle.")


def _check_profile(pouring: PouringParameters, gamma: FloatArray, move: PlannedMove) -> float:
    """The turn's own time; refuses a turn that is anywhere faster than the imagined one."""
    times = SAMPLE_S * np.arange(len(gamma))
    imagined = np.array([pour_angle(pouring, time)[0] for time in times])
    rate = np.diff(gamma) / SAMPLE_S
    top = imagined_rate(pouring, np.clip(np.minimum(gamma[1:], gamma[:-1]), 0, None))
    ahead = (gamma > imagined + _ANGLE_RAD).any()
    if ahead or not (rate <= top * (1 + _RATE_SHARE) + _RATE_RAD_S).all():
        raise MotionError(f"In the move '{move.name}' the cup turns faster than imagined.")
    moving = np.flatnonzero(np.abs(rate) > _RATE_RAD_S * 1e-3)
    begins, ends = moving[0], moving[-1] + 1
    if begins * SAMPLE_S < pouring.settle_s - SAMPLE_S or times[-1] - times[ends] < pouring.wait_s - SAMPLE_S:
        raise MotionError(f"In the move '{move.name}' the cup does not rest as long as imagined.")
    return float(times[ends] - times[begins])
