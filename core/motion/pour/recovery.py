"""The way back after a stop: along the ways that were checked, so that the cup returns upright and full."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.plan import MovePhase, PlannedMove, PourPlan
from core.motion.trajectory import SAMPLE_S, JointTrajectory

MOST_BESIDE_RAD = 0.1
"""A braking arm stays on its way but for the lag of its servo; farther beside, somebody pushed it."""
_AT_STATION_RAD = 5e-3
"""As far as the driver lets an arm rest from where it was sent, with room to spare: 4 mm at full reach."""
_NO_DISTANCE_RAD = 5e-4
_JOINING_RAD_S = 0.1
_SPEEDING_UP_S = 1.0


def plan_back_off(
    plan: PourPlan, moves: tuple[PlannedMove, ...], index: int, joints_rad: FloatArray
) -> tuple[PlannedMove, ...]:
    """Plan from where the arm was stopped to its rest, the cup put down at its station on the way.

    On the way out it goes back; on the way back it goes on, which leads home too. Nothing is poured.

    Args:
        plan: of the pour that was stopped.
        moves: that were under way: the plan's, or those of an earlier way back.
        index: of the move that was stopped.
        joints_rad: (6,) where the arm stands now.

    Raises:
        MotionError: the arm stands beside its way.
    """
    stopped = moves[index]
    begin: tuple[PlannedMove, ...] = ()
    if stopped.phase is MovePhase.BACK:
        way, rest = stopped, moves[index + 1 :]
    else:
        counterpart = len(plan.moves) - 1 - index
        back = replace(plan.moves[counterpart], trajectory=stopped.trajectory.reversed())
        way, rest = back, plan.moves[counterpart + 1 :]
        if stopped.gripper_after is not None and _stands_at_end(stopped.trajectory, joints_rad):
            # It was stopped while it took the cup: the gripper may hold it already, at its station.
            begin = (_let_go(stopped, joints_rad),)
    nearest, beside_rad = _nearest(way.trajectory, joints_rad)
    if beside_rad > MOST_BESIDE_RAD:
        raise MotionError(
            f"The arm stands {np.degrees(beside_rad):.0f} degrees beside its planned way; put the cup away "
            "by hand, drive the arm home at its panel, and pour anew."
        )
    first = replace(way, trajectory=_remainder(way.trajectory, nearest))
    if beside_rad < _NO_DISTANCE_RAD:
        return (*begin, first, *rest)
    return (*begin, _join(way, joints_rad, first.trajectory.start_rad), first, *rest)


def _stands_at_end(trajectory: JointTrajectory, joints_rad: FloatArray) -> bool:
    return float(np.abs(trajectory.end_rad - joints_rad).max()) < _AT_STATION_RAD


def _let_go(stopped: PlannedMove, joints_rad: FloatArray) -> PlannedMove:
    """Stand for a moment, then open the gripper."""
    standing = JointTrajectory(np.array([0.0, _SPEEDING_UP_S]), np.stack([joints_rad, joints_rad]))
    return PlannedMove("let go of the cup", MovePhase.BACK, standing, stopped.holds_cup, "open")


def _nearest(trajectory: JointTrajectory, joints_rad: FloatArray) -> tuple[int, float]:
    """Index of the sample that is nearest, and how far the farthest joint is from it."""
    beside_rad = np.abs(trajectory.joints_rad - joints_rad).max(axis=1)
    nearest = int(beside_rad.argmin())
    return nearest, float(beside_rad[nearest])


def _join(way: PlannedMove, start_rad: FloatArray, goal_rad: FloatArray) -> PlannedMove:
    """The little way back to the checked one."""
    duration_s = float(np.abs(goal_rad - start_rad).max()) / _JOINING_RAD_S + _SPEEDING_UP_S
    share = _from_rest_to_rest(duration_s)
    joints = start_rad + share[:, None] * (goal_rad - start_rad)
    trajectory = JointTrajectory(np.arange(len(share), dtype=float) * SAMPLE_S, joints)
    return PlannedMove("back on the way", MovePhase.BACK, trajectory, way.holds_cup, None)


def _remainder(trajectory: JointTrajectory, begin: int) -> JointTrajectory:
    """The same way from a sample on, at less than its speed, from rest."""
    begin_s = trajectory.times_s[begin]
    left_s = trajectory.duration_s - begin_s
    share = _from_rest_to_rest(2 * left_s + _SPEEDING_UP_S)
    times_s = begin_s + share * left_s
    joints = np.stack([np.interp(times_s, trajectory.times_s, q) for q in trajectory.joints_rad.T], axis=1)
    return JointTrajectory(np.arange(len(share), dtype=float) * SAMPLE_S, joints)


def _from_rest_to_rest(duration_s: float) -> FloatArray:
    """Share (N,) of a way that is done, every 8 ms: a cubic with no speed at its ends."""
    u = np.linspace(0, 1, max(int(np.ceil(duration_s / SAMPLE_S)), 1) + 1)
    return np.asarray(u * u * (3 - 2 * u))
