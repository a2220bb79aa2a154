"""From a way to the moves of a plan, with their times."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.imagination.cup import pour_angle
from core.motion.pour.legs import ToolLeg, joined, standing
from core.motion.pour.plan import MOVES, PlannedMove
from core.motion.pour.scene import PourScene
from core.motion.pour.search import Way, lay_grasps
from core.motion.pour.timing import SpeedLimits
from core.motion.pour.turns import turn_grasps
from core.motion.trajectory import JointTrajectory
from core.parameters.imagination import PouringParameters

_TURN_PLACES = 200


def build_moves(scene: PourScene, pouring: PouringParameters, way: Way) -> tuple[PlannedMove, ...]:
    """Return all moves of a way; the ways back are the ways out, reversed.

    Raises:
        MotionError: the arm cannot follow somewhere between the places that were tried.
    """
    grip, branch = way.grip, way.turn.branch
    slow = SpeedLimits.on_the_way(scene.cell.limits)
    here = grip.lift.end_rad
    stretches = []
    for stretch in way.carry:
        stretches.append(stretch.leg.trajectory(scene, branch, here, slow))
        here = stretches[-1].end_rad
    carry = joined(stretches) if stretches else standing(here, 0.0)
    lay = _lay(pouring, way).trajectory(scene, branch, carry.end_rad, slow)
    lower = _lower(pouring, way).trajectory(scene, branch, lay.end_rad, slow)
    turn = _turn_leg(scene, pouring, way).trajectory(
        scene, branch, lower.end_rad, SpeedLimits.in_the_turn(scene.cell.limits)
    )
    pour = joined([standing(turn.start_rad, pouring.settle_s), turn, standing(turn.end_rad, pouring.wait_s)])
    out = [grip.approach, grip.grasp, grip.lift, carry, lay, lower, pour]
    back = [part.reversed() for part in (turn, lower, lay, carry, grip.lift, grip.grasp)]
    return named_moves([*out, *back, grip.home])


def named_moves(trajectories: list[JointTrajectory]) -> tuple[PlannedMove, ...]:
    """Give the moves of a plan their names."""
    return tuple(
        PlannedMove(name, phase, trajectory, holds_cup, gripper_after)
        for (name, phase, holds_cup, gripper_after), trajectory in zip(MOVES, trajectories, strict=True)
    )


def _lay(pouring: PouringParameters, way: Way) -> ToolLeg:
    def poses(shares: FloatArray) -> FloatArray:
        return lay_grasps(pouring, way.task, way.turn, way.upright_m, way.spin_rad, way.ready_m, shares)

    length = float(np.linalg.norm(way.ready_m - way.upright_m))
    return ToolLeg.of_length(poses, length, np.pi / 2 + abs(way.spin_rad))


def _lower(pouring: PouringParameters, way: Way) -> ToolLeg:
    down = way.initial_m - way.ready_m
    lying = lay_grasps(pouring, way.task, way.turn, way.ready_m, 0.0, way.ready_m, np.ones(1))

    def poses(shares: FloatArray) -> FloatArray:
        lowered = np.repeat(lying, len(shares), axis=0)
        lowered[:, :3, 3] = way.ready_m + shares[:, None] * down
        return lowered

    return ToolLeg.of_length(poses, float(np.linalg.norm(down)), 0.0)


def _turn_leg(scene: PourScene, pouring: PouringParameters, way: Way) -> ToolLeg:
    """The turn about the pivot; its places are the pour angle gamma, its top rate the imagined one."""

    def poses(gammas: FloatArray) -> FloatArray:
        return turn_grasps(scene, pouring.cup, way.task, way.turn.psi_rad, gammas)

    gammas = np.linspace(0, pouring.gamma_0_rad, _TURN_PLACES + 1)
    return ToolLeg(poses, gammas, imagined_rate(pouring, gammas))


def imagined_rate(pouring: PouringParameters, gamma_rad: FloatArray) -> FloatArray:
    """How fast (N,) the imagined turn is at pour angles (N,), in rad/s; zero at the end of the turn."""
    _, at_first = pour_angle(pouring, pouring.settle_s + 1e-12)
    share = np.clip(gamma_rad / pouring.gamma_0_rad, 0, 1)
    return np.asarray(at_first * np.sqrt(1 - share**2))
