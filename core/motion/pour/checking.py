"""The last word on a plan: every sample of every move, from scratch, whatever made the plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.inverse_kinematics import branch_of
from core.motion.joint_path import JOINT_NAMES, STEP_RAD
from core.motion.kinematics import singularity_measure, within_limits
from core.motion.pour.cell import PourCell
from core.motion.pour.handling import check_handling
from core.motion.pour.legs import acceleration_rad_s2
from core.motion.pour.plan import MOVES, PlannedMove, PourPlan
from core.motion.pour.room import Room, check_room, distinct
from core.motion.pour.scene import PourScene
from core.motion.pour.timing import STEP_M, SpeedLimits
from core.motion.pour.turning import check_turn
from core.motion.trajectory import SAMPLE_S
from core.parameters.imagination import PouringParameters

_SAME_RAD = 1e-6
_ROUNDING = 1 + 1e-6
_CLOCK_S = 1e-9
ON_THE_WAY = frozenset({"carry", "lay", "lower", "pour", "turn back", "raise", "stand up", "carry back"})
"""The moves with the cup away from its station."""
_TURNING = frozenset({"pour", "turn back"})


@dataclass(frozen=True)
class PlanFigures:
    """What was measured on a plan's samples; see `PourPlan`."""

    clearance_m: float
    nearest: tuple[str, str]
    cup_clearance_m: float
    pivot_error_m: float
    singularity: float
    turn_s: float

    def as_table(self) -> dict[str, Any]:
        """By name."""
        return asdict(self)


def check_plan(
    cell: PourCell,
    object_aabb_m: FloatArray,
    pouring: PouringParameters,
    plan: PourPlan,
    pivot_m: FloatArray,
    theta_rad: float,
) -> None:
    """Verify every sample of a plan again, for a cell, an object (2, 3) and a pour.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    scene = PourScene(cell, object_aabb_m, pouring.cup)
    examine(scene, pouring, plan.moves, plan.T_grasp_cup, pivot_m, theta_rad)


def examine(
    scene: PourScene,
    pouring: PouringParameters,
    moves: Sequence[PlannedMove],
    T_grasp_cup: FloatArray,
    pivot_m: FloatArray,
    theta_rad: float,
    at_station: Room | None = None,
) -> PlanFigures:
    """Verify every sample of a plan's moves and return what was measured.

    Whoever has just checked the room of the moves at the station may hand it over: many pours share them.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    _check_sequence(scene, moves)
    known: set[tuple[bool, bytes]] = set()
    for move in moves:
        _check_samples(scene, move)
        joints, is_turn = move.trajectory.joints_rad, move.name in _TURNING
        if (is_turn, joints.tobytes()) not in known:
            _check_speeds(scene, move)
        # a way back is as fast as the way out
        known.add((is_turn, joints[::-1].tobytes()))
    singularity = _check_branch(scene, [move for move in moves if move.holds_cup])
    check_handling(scene, pouring, moves, T_grasp_cup)
    pivot_error, turn_s = check_turn(scene, pouring, moves, T_grasp_cup, pivot_m, theta_rad)
    if at_station is None:
        room = check_room(scene, moves)
    else:
        room = check_room(scene, [move for move in moves if move.name in ON_THE_WAY]).with_other(at_station)
    return PlanFigures(room.clearance_m, room.nearest, room.cup_clearance_m, pivot_error, singularity, turn_s)


def _check_sequence(scene: PourScene, moves: Sequence[PlannedMove]) -> None:
    facts = tuple((move.name, move.phase, move.holds_cup, move.gripper_after) for move in moves)
    if facts != MOVES:
        raise MotionError("The plan's moves are not those of a pour in their order; plan the pour again.")
    for before, after in pairwise(moves):
        gap = float(np.abs(after.trajectory.start_rad - before.trajectory.end_rad).max())
        if not gap <= _SAME_RAD:
            raise MotionError(
                f"The move '{after.name}' begins {np.degrees(gap):.2g} degrees from where '{before.name}' "
                "ends; plan the pour again."
            )
    away = float(np.abs(moves[-1].trajectory.end_rad - scene.cell.home_rad).max())
    if not away <= _SAME_RAD:
        raise MotionError("The plan does not end where the arm rests; plan the pour again.")


def _check_samples(scene: PourScene, move: PlannedMove) -> None:
    """Samples every 8 ms, within the joints' limits."""
    times, joints = move.trajectory.times_s, move.trajectory.joints_rad
    if joints.shape != (len(times), 6) or len(times) < 2 or not np.isfinite(joints).all():
        raise MotionError(f"The move '{move.name}' has no proper samples; plan the pour again.")
    if not np.abs(times - SAMPLE_S * np.arange(len(times))).max() <= _CLOCK_S:
        raise MotionError(f"The move '{move.name}' is not sampled every 8 ms; plan the pour again.")
    inside = within_limits(scene.cell.arm, joints)
    if not inside.all():
        joint = JOINT_NAMES[int((~inside).any(axis=0).argmax())]
        raise MotionError(f"In the move '{move.name}' the {joint} joint is beyond its limit.")


def _check_speeds(scene: PourScene, move: PlannedMove) -> None:
    """Not too fast, and samples near to each other."""
    joints, settings = move.trajectory.joints_rad, scene.cell.limits
    is_turn = move.name in _TURNING
    limits = SpeedLimits.in_the_turn(settings) if is_turn else SpeedLimits.on_the_way(settings)
    steps = np.diff(joints, axis=0)
    points = scene.hand_points(scene.grasp_poses(joints))
    acceleration = acceleration_rad_s2(move.trajectory)
    measured = (
        ("a joint turns with", np.abs(steps).max() / SAMPLE_S, limits.joint_speed_rad_s, "rad/s"),
        ("a joint speeds up by", acceleration, limits.joint_acceleration_rad_s2, "rad/s²"),
        ("the hand moves with", _longest(points[:, :1]) / SAMPLE_S, limits.tool_speed_m_s, "m/s"),
        ("two samples of a joint differ by", np.abs(steps).max(), STEP_RAD, "rad"),
        ("the cup leaps by", _longest(points), STEP_M, "m"),
    )
    for what, value, limit, unit in measured:
        if not value <= limit * _ROUNDING:
            raise MotionError(
                f"In the move '{move.name}' {what} {value:.3g} {unit}, where {limit:.3g} {unit} is allowed."
            )


def _longest(points_m: FloatArray) -> float:
    """The longest step of points (N, P, 3)."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=2).max(initial=0))


def _check_branch(scene: PourScene, moves: Sequence[PlannedMove]) -> float:
    """One branch for as long as the cup is held; the smallest singularity measure."""
    joints, owners = distinct(moves)
    branches = branch_of(scene.cell.arm, joints)
    measures = singularity_measure(scene.cell.arm, joints)
    k, wanted = int(measures.argmin()), scene.cell.limits.min_singularity
    if not measures[k] >= wanted:
        raise MotionError(
            f"In the move '{moves[owners[k]].name}' the arm comes too near to a singular configuration "
            f"({measures[k]:.3f}, where {wanted:g} is allowed)."
        )
    if (branches != branches[0]).any():
        name = moves[owners[int((branches != branches[0]).argmax())]].name
        raise MotionError(f"In the move '{name}' the arm changes its branch with the cup in its hand.")
    return float(measures[k])
