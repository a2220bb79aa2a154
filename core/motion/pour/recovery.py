"""Backing off after a stop: along the checked path, so that the cup returns upright and full."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.cell import PourCell
from core.motion.pour.plan import MovePhase, PlannedMove, PourPlan, PourTarget, Segment
from core.motion.pour.scene import PourScene, check_clearance
from core.motion.trajectory import SAMPLE_S, JointTrajectory

MAX_DEVIATION_RAD = 0.1
"""A braking arm stays on its path except for the servo's lag; a larger deviation means it was pushed."""
_AT_STATION_RAD = 5e-3
"""The driver's tolerance for an arm at rest where it was sent, and some more: 4 mm at full reach."""
_NO_DISTANCE_RAD = 5e-4
_JOINING_RAD_S = 0.1
_ACCELERATING_S = 1.0
_BY_HAND = "take the cup out of the hand by hand and plan from here."


def plan_back_off(
    plan: PourPlan, moves: tuple[PlannedMove, ...], index: int, joints_rad: FloatArray
) -> tuple[PlannedMove, ...]:
    """Plan from where the arm was stopped to home, putting the cup down at its station.

    If it was moving out, it reverses; if it was moving back, it continues, which leads home too. Nothing is
    poured.

    Args:
        plan: of the pour that was stopped.
        moves: that were being executed: the plan's, or those of an earlier back-off.
        index: of the move that was stopped.
        joints_rad: (6,) the present configuration.

    Raises:
        MotionError: the arm is not on its path.
    """
    stopped = moves[index]
    begin: tuple[PlannedMove, ...] = ()
    if stopped.phase is MovePhase.BACK:
        interrupted, rest = stopped, moves[index + 1 :]
    else:
        counterpart = len(plan.moves) - 1 - index
        interrupted = replace(plan.moves[counterpart], trajectory=stopped.trajectory.reversed())
        rest = plan.moves[counterpart + 1 :]
        if stopped.gripper_after is not None and _is_at_end(stopped.trajectory, joints_rad):
            # It was stopped while it took the cup: the gripper may hold it already, at its station.
            begin = (_let_go(stopped, joints_rad),)
    nearest, deviation_rad = _nearest(interrupted.trajectory, joints_rad)
    if deviation_rad > MAX_DEVIATION_RAD:
        raise MotionError(
            f"The arm is {np.degrees(deviation_rad):.0f} degrees off its planned path; {_BY_HAND}"
        )
    first = replace(interrupted, trajectory=_remainder(interrupted.trajectory, nearest))
    if deviation_rad < _NO_DISTANCE_RAD:
        return (*begin, first, *rest)
    return (*begin, _rejoin(interrupted, joints_rad, first.trajectory.start_rad), first, *rest)


def check_rejoining(cell: PourCell, target: PourTarget, moves: Sequence[PlannedMove]) -> None:
    """Check the bit by which a way back joins the checked path: beside it nothing was checked.

    A plan keeps its clearances and no more, so that an arm beside its path has less: half of them is enough.
    An arm that was pushed nearer than that may leave, as long as it comes no nearer on its way.

    Raises:
        MotionError: it is not clear; the sentence says what a person has to do.
    """
    for move, following in pairwise(moves):
        if move.name is not Segment.REJOIN:
            continue
        joining = replace(move, name=following.name)
        try:
            here = check_clearance(_scene_with(cell, target, 0.0, 0.0), [_standing(joining)])
            check_clearance(
                _scene_with(
                    cell,
                    target,
                    min(cell.limits.min_clearance_m / 2, here.clearance_m),
                    min(cell.limits.cup_clearance_m / 2, here.cup_clearance_m),
                ),
                [joining],
            )
        except MotionError as error:
            raise MotionError(
                f"The arm is beside its planned path, and the way to it is not clear: {error} "
                f"{_BY_HAND.capitalize()}"
            ) from error


def _scene_with(
    cell: PourCell, target: PourTarget, min_clearance_m: float, cup_clearance_m: float
) -> PourScene:
    limits = cell.limits.model_copy(
        update={"min_clearance_m": min_clearance_m, "cup_clearance_m": cup_clearance_m}
    )
    return PourScene(replace(cell, limits=limits), target.object_aabb_m, target.pouring.cup)


def _standing(move: PlannedMove) -> PlannedMove:
    """Where a move begins, and no further."""
    start_rad = move.trajectory.start_rad
    return replace(
        move, trajectory=JointTrajectory(np.array([0.0, SAMPLE_S]), np.stack([start_rad, start_rad]))
    )


def on_the_way_back(plan: PourPlan, joints_rad: FloatArray) -> int | None:
    """Return the index of the move back with the cup on whose path an arm at (6,) is; none if it is not."""
    found = [
        (_nearest(move.trajectory, joints_rad)[1], index)
        for index, move in enumerate(plan.moves)
        if move.phase is MovePhase.BACK and move.holds_cup
    ]
    deviation_rad, index = min(found)
    return index if deviation_rad <= MAX_DEVIATION_RAD else None


def _is_at_end(trajectory: JointTrajectory, joints_rad: FloatArray) -> bool:
    return float(np.abs(trajectory.end_rad - joints_rad).max()) < _AT_STATION_RAD


def _let_go(stopped: PlannedMove, joints_rad: FloatArray) -> PlannedMove:
    """Pause for a moment, then open the gripper."""
    pause = JointTrajectory(np.array([0.0, _ACCELERATING_S]), np.stack([joints_rad, joints_rad]))
    return PlannedMove(Segment.LET_GO, MovePhase.BACK, pause, stopped.holds_cup, "open")


def _nearest(trajectory: JointTrajectory, joints_rad: FloatArray) -> tuple[int, float]:
    """Index of the nearest sample, and the largest distance of a joint from it."""
    deviation_rad = np.abs(trajectory.joints_rad - joints_rad).max(axis=1)
    nearest = int(deviation_rad.argmin())
    return nearest, float(deviation_rad[nearest])


def _rejoin(interrupted: PlannedMove, start_rad: FloatArray, goal_rad: FloatArray) -> PlannedMove:
    """The short move back to the checked path."""
    duration_s = float(np.abs(goal_rad - start_rad).max()) / _JOINING_RAD_S + _ACCELERATING_S
    share = _from_rest_to_rest(duration_s)
    joints = start_rad + share[:, None] * (goal_rad - start_rad)
    trajectory = JointTrajectory.of_samples(joints)
    return PlannedMove(Segment.REJOIN, MovePhase.BACK, trajectory, interrupted.holds_cup, None)


def _remainder(trajectory: JointTrajectory, begin: int) -> JointTrajectory:
    """The same path from a sample on, more slowly, from rest."""
    begin_s = trajectory.times_s[begin]
    left_s = trajectory.duration_s - begin_s
    share = _from_rest_to_rest(2 * left_s + _ACCELERATING_S)
    times_s = begin_s + share * left_s
    joints = np.stack([np.interp(times_s, trajectory.times_s, q) for q in trajectory.joints_rad.T], axis=1)
    return JointTrajectory.of_samples(joints)


def _from_rest_to_rest(duration_s: float) -> FloatArray:
    """Share (N,) of a path that is done, every 8 ms: a cubic with zero speed at its ends."""
    u = np.linspace(0, 1, max(int(np.ceil(duration_s / SAMPLE_S)), 1) + 1)
    return np.asarray(u * u * (3 - 2 * u))
