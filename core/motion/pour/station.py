"""Taking the cup at its station: the directions from which the hand may come, and the paths to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import BoolArray, FloatArray
from core.motion.joint_path import RouteSettings, find_route
from core.motion.kinematics import (
    N_BRANCHES,
    TURN_RAD,
    inverse_kinematics,
    nearest_turn,
    singularity_measure,
    within_limits,
)
from core.motion.pour.geometry import upright_grasps
from core.motion.pour.plan import MOVES, PlannedMove, Segment
from core.motion.pour.scene import LeastClearance, PourScene, check_clearance, supports
from core.motion.pour.tool_path import SpeedLimits, ToolPath, joint_trajectory
from core.motion.trajectory import JointTrajectory

N_AZIMUTHS = 24
BACK_OFF_M = 0.08
"""The hand approaches the cup, and leaves it, in a straight line of this length."""
_PER_BRANCH, _MOST_GRIPS = 1, 2
_MOST_TRIES = 12
_MOST_SEARCHES, _SEARCH_S = 2, 0.8
_ROUTE_SLACK_M = 0.001
"""Extra clearance, for what lies between the degrees at which a route is checked."""


@dataclass(frozen=True)
class Grip:
    """One way to take the cup at its station.

    Attributes:
        azimuth_rad: of the tool frame's x-axis.
        branch: of the inverse kinematics, for as long as the cup is in the hand.
        approach: from the arm's present configuration to before the cup.
        grasp: straight to the cup.
        lift: straight up with it.
        home: from before the cup to the home configuration.
        clearance: the smallest distances during all these.
    """

    azimuth_rad: float
    branch: int
    approach: JointTrajectory
    grasp: JointTrajectory
    lift: JointTrajectory
    home: JointTrajectory
    clearance: LeastClearance


def lifted_m(scene: PourScene) -> FloatArray:
    """Position (3,) of the tool frame when the cup has been lifted."""
    return np.asarray(_grasp_m(scene) + np.array([0, 0, scene.cell.limits.lift_m]))


def find_grips(scene: PourScene, start_rad: FloatArray) -> tuple[Grip, ...]:
    """Return some ways to take the cup, those nearest to home first, checked sample by sample.

    Raises:
        MotionError: the station is out of reach or blocked.
    """
    found = _reachable_grips(scene, supports(scene))
    grips: list[Grip] = []
    problem: MotionError | None = None
    for azimuth, branch, before_rad in found[:_MOST_TRIES]:
        if sum(grip.branch == branch for grip in grips) == _PER_BRANCH:
            continue
        try:
            grips.append(_grip(scene, azimuth, branch, before_rad, start_rad, 0.0))
        except MotionError as error:
            problem = problem or error
        if len(grips) == _MOST_GRIPS:
            break
    # the long search only where no quick path is clear
    for azimuth, branch, before_rad in [] if grips else found[:_MOST_SEARCHES]:
        try:
            return (_grip(scene, azimuth, branch, before_rad, start_rad, _SEARCH_S),)
        except MotionError as error:
            problem = error
    if not grips:
        raise MotionError(f"The arm cannot reach the cup at its station: {problem}") from problem
    return tuple(grips)


def _reachable_grips(scene: PourScene, on: frozenset[str]) -> list[tuple[float, int, FloatArray]]:
    """Azimuth, branch and configuration before the cup (6,) of what is allowed, judged at a few poses."""
    azimuths = np.arange(N_AZIMUTHS) * TURN_RAD / N_AZIMUTHS
    poses = np.concatenate([_grip_poses(scene, azimuth) for azimuth in azimuths])
    n_poses = len(poses) // N_AZIMUTHS
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(poses))
    found = result.found.reshape(N_AZIMUTHS, n_poses, N_BRANCHES).all(axis=1)
    if not found.any():
        raise MotionError(
            "The arm cannot reach the cup at its station from any side; correct cup_station_m or the "
            "gripper's T_flange_grasp in the cell file."
        )
    joints = result.joints_rad.reshape(N_AZIMUTHS, n_poses, N_BRANCHES, 6)
    which = np.argwhere(found)
    paths = nearest_turn(scene.cell.arm, joints.transpose(0, 2, 1, 3)[found], scene.cell.home_rad)
    allowed = _allowed(scene, paths, on)
    from_home = np.abs(paths[:, 0] - scene.cell.home_rad).max(axis=1)
    order = [int(k) for k in np.argsort(from_home, kind="stable") if allowed[k]]
    return [(float(azimuths[which[k, 0]]), int(which[k, 1]), paths[k, 0]) for k in order]


def _grip_poses(scene: PourScene, azimuth_rad: float) -> FloatArray:
    """Poses (5, 4, 4) of the tool frame before the cup, at it, and above it."""
    at = _grasp_m(scene)
    lift = np.array([0, 0, scene.cell.limits.lift_m])
    back = _back_off(scene, azimuth_rad)
    positions = np.array([at + back, at + back / 2, at, at + lift / 2, at + lift])
    return upright_grasps(positions, np.full(len(positions), azimuth_rad))


def _allowed(scene: PourScene, paths_rad: FloatArray, on: frozenset[str]) -> BoolArray:
    """Which paths (W, 5, 6) are clear.

    Raises:
        MotionError: none is; says what obstructs the best one.
    """
    limits, shape = scene.cell.limits, paths_rad.shape[:2]
    flat = paths_rad.reshape(-1, 6)
    inside = within_limits(scene.cell.arm, paths_rad).all(axis=(1, 2))
    regular = singularity_measure(scene.cell.arm, paths_rad).min(axis=1) >= limits.min_singularity
    cup = scene.cup_clearance(scene.station_pose[None], flat, on).distance_m.reshape(shape)
    free = inside & regular & (cup[:, :3].min(axis=1) >= limits.cup_clearance_m)
    if not free.any():
        raise MotionError(
            "The arm cannot take the cup at its station: it would touch the cup, be near a singular "
            "configuration or beyond a joint limit; correct cup_station_m or T_flange_grasp in the cell "
            "file."
        )
    clearance = scene.hand.clearance(flat)
    hand = np.where(free[:, None], clearance.distance_m.reshape(shape), -np.inf)
    allowed: BoolArray = hand.min(axis=1) >= limits.min_clearance_m
    if not allowed.any():
        best = int(hand.min(axis=1).argmax())
        worst = best * shape[1] + int(hand[best].argmin())
        first, second = clearance.nearest(worst)
        raise MotionError(
            f"The arm cannot take the cup at its station: the {first} would be "
            f"{clearance.distance_m[worst] * 1000:.0f} mm from the {second}, where "
            f"{limits.min_clearance_m * 1000:.0f} mm are required; correct cup_station_m or grip_height_m in "
            "the cell file."
        )
    return allowed


def _grip(
    scene: PourScene,
    azimuth: float,
    branch: int,
    before_rad: FloatArray,
    start_rad: FloatArray,
    search_s: float,
) -> Grip:
    home = scene.cell.home_rad
    approach = _free_path(scene, start_rad, before_rad, search_s)
    retreat = approach if np.array_equal(start_rad, home) else _free_path(scene, home, before_rad, search_s)
    speeds = SpeedLimits.of_transfer(scene.cell.limits)
    at, back = _grasp_m(scene), _back_off(scene, azimuth)
    up = np.array([0, 0, scene.cell.limits.lift_m])
    grasp = _straight(at + back, -back, azimuth).trajectory(scene, branch, before_rad, speeds)
    lift = _straight(at, up, azimuth).trajectory(scene, branch, grasp.end_rad, speeds)
    parts = {
        Segment.TO_CUP: approach,
        Segment.GRASP: grasp,
        Segment.LIFT: lift,
        Segment.HOME: retreat.reversed(),
    }
    moves = [PlannedMove(*facts[:2], parts[facts[0]], *facts[2:]) for facts in MOVES if facts[0] in parts]
    return Grip(azimuth, branch, approach, grasp, lift, parts[Segment.HOME], check_clearance(scene, moves))


def _free_path(
    scene: PourScene, start_rad: FloatArray, goal_rad: FloatArray, search_s: float
) -> JointTrajectory:
    limits, home = scene.cell.limits, tuple(scene.cell.home_rad.tolist())
    settings = RouteSettings(limits.min_clearance_m + _ROUTE_SLACK_M, (home,), search_s)
    route = find_route(scene.route, start_rad, goal_rad, settings)
    return joint_trajectory(scene, route, SpeedLimits.of_transfer(limits))


def _straight(start_m: FloatArray, displacement_m: FloatArray, azimuth_rad: float) -> ToolPath:
    """The upright hand from a position (3,) along a straight displacement (3,)."""

    def poses(shares: FloatArray) -> FloatArray:
        return upright_grasps(start_m + shares[:, None] * displacement_m, np.full(len(shares), azimuth_rad))

    return ToolPath.of_length(poses, float(np.linalg.norm(displacement_m)), 0.0)


def _grasp_m(scene: PourScene) -> FloatArray:
    return np.asarray(scene.cell.cup_station_m + np.array([0, 0, scene.cell.grip_height_m]))


def _back_off(scene: PourScene, azimuth_rad: float) -> FloatArray:
    """The horizontal displacement (3,) from the grasp to before the cup: against the flange's z."""
    hand = upright_grasps(np.zeros((1, 3)), np.array([azimuth_rad]))[0, :3, :3]
    out = -hand @ scene.cell.T_flange_grasp[2, :3] * np.array([1, 1, 0])
    return np.asarray(BACK_OFF_M * out / max(float(np.linalg.norm(out)), 1e-9))
