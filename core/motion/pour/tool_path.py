"""From a path of the tool frame, or of the joints, to a trajectory as fast as every limit allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf, sqrt

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import STEP_RAD
from core.motion.kinematics import TURN_RAD, inverse_kinematics
from core.motion.pour.cell import MotionSettings
from core.motion.pour.scene import PourScene
from core.motion.trajectory import SAMPLE_S, JointTrajectory

Poses = Callable[[FloatArray], FloatArray]
"""From parameters (N,) along a path to `T_base_grasp` (N, 4, 4)."""
_PATH_RAD, _PATH_M = np.radians(0.5), 0.0025
"""Spacing of the points at which a path is timed."""
_FEWEST_POINTS = 16
_SAME_RAD = 1e-9
_LARGEST_STEP_RAD = np.radians(5.0)
"""No joint moves farther between two points of a path; ten times as far as the hand rotates."""
_TRIES = 5
_MARGIN = 1.02
"""A path that bends more sharply between its points is timed again, with a limit lower by this."""
STEP_M = 0.005
"""The tool moves no farther between two samples of a trajectory."""
_SHARE = 0.97
"""Of each limit: the rest is for what lies between the points of a path."""
_TINY = 1e-9


@dataclass(frozen=True)
class SpeedLimits:
    """Limits along a path.

    Attributes:
        joint_speed_rad_s: of every joint.
        joint_acceleration_rad_s2: of every joint.
        tool_speed_m_s: of the tool frame's origin; inf for none.
    """

    joint_speed_rad_s: float
    joint_acceleration_rad_s2: float
    tool_speed_m_s: float

    @classmethod
    def of_transfer(cls, limits: MotionSettings) -> SpeedLimits:
        """Outside the pour rotation."""
        return cls(limits.joint_speed_rad_s, limits.joint_acceleration_rad_s2, limits.tool_speed_m_s)

    @classmethod
    def of_pour(cls, limits: MotionSettings) -> SpeedLimits:
        """During the pour rotation, and back."""
        return cls(limits.pour_joint_speed_rad_s, limits.pour_acceleration_rad_s2, inf)


@dataclass(frozen=True)
class ToolPath:
    """A smooth path of the tool frame on one branch of the inverse kinematics, from rest to rest.

    Attributes:
        poses: of the tool frame at parameters along the path.
        points: (K,) parameters, rising, dense enough for finite differences.
        top_rate: (K,) highest rate of the parameter per second, or none.
    """

    poses: Poses
    points: FloatArray
    top_rate: FloatArray | None = None

    @classmethod
    def of_length(cls, poses: Poses, length_m: float, rotation_rad: float) -> ToolPath:
        """A path with parameters from 0 to 1 of about this length and rotation."""
        n = max(int(length_m / _PATH_M), int(rotation_rad / _PATH_RAD), _FEWEST_POINTS)
        return cls(poses, np.linspace(0, 1, n + 1))

    def trajectory(
        self, scene: PourScene, branch: int, start_rad: FloatArray, limits: SpeedLimits
    ) -> JointTrajectory:
        """Follow it from the configuration (6,) at its start.

        Raises:
            MotionError: a point is out of reach, or the path passes a singular configuration.
        """
        poses = self.poses(self.points)
        joints = _continued(_branch_joints(scene, branch, poses), start_rad)
        if np.abs(np.diff(joints, axis=0)).max() > _LARGEST_STEP_RAD:
            raise MotionError(
                "Between two points of the path a joint would jump at a singular configuration."
            )
        tool_points = scene.hand_points(poses)
        slower = limits
        for _ in range(_TRIES):
            timed = timed_points(self.points, joints, tool_points, slower, self.top_rate)
            exact = _branch_joints(scene, branch, self.poses(timed))
            near = np.stack([np.interp(timed, self.points, column) for column in joints.T], axis=1)
            result = JointTrajectory.of_samples(exact + TURN_RAD * np.round((near - exact) / TURN_RAD))
            excess = result.peak_acceleration_rad_s2 / limits.joint_acceleration_rad_s2
            if excess <= 1:
                return result
            acceleration = slower.joint_acceleration_rad_s2 / (excess * _MARGIN)
            slower = replace(slower, joint_acceleration_rad_s2=acceleration)
        raise MotionError("The path has a bend that is too sharp for the arm.")


def _branch_joints(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> FloatArray:
    """Configurations (N, 6) on a branch for poses (N, 4, 4) of the tool frame, each within half a turn.

    Raises:
        MotionError: a pose is out of reach.
    """
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(T_base_grasp), (branch,))
    if not result.found.all() or result.undetermined.any():
        raise MotionError("The arm cannot follow the path of the hand; it is out of reach.")
    return result.joints_rad[:, 0]


def _continued(joints_rad: FloatArray, start_rad: FloatArray) -> FloatArray:
    """Shift configurations (N, 6) of a path by whole turns so that it continues from (6,)."""
    whole = np.unwrap(joints_rad, axis=0)
    return np.asarray(whole + TURN_RAD * np.round((start_rad - whole[0]) / TURN_RAD))


def joint_trajectory(scene: PourScene, corners_rad: FloatArray, limits: SpeedLimits) -> JointTrajectory:
    """Straight joint moves through configurations (M, 6), at rest at each."""

    def timed(shares: FloatArray, samples: FloatArray) -> FloatArray:
        return timed_points(shares, samples, scene.hand_points(scene.grasp_poses(samples)), limits)

    return _through_corners(corners_rad, timed)


def slow_joint_trajectory(
    scene: MotionScene, corners_rad: FloatArray, limits: SpeedLimits
) -> JointTrajectory:
    """The same, with no point of arm and tools faster than the limit of the tool's speed."""

    def timed(shares: FloatArray, samples: FloatArray) -> FloatArray:
        points_m = scene.capsule_ends(samples).reshape(len(samples), -1, 3)
        slopes = np.linalg.norm(np.gradient(points_m, shares, axis=0), axis=2).max(axis=1)
        top_rate = _SHARE * limits.tool_speed_m_s / np.maximum(slopes, _TINY)
        return timed_points(shares, samples, points_m, limits, top_rate)

    return _through_corners(corners_rad, timed)


def _through_corners(
    corners_rad: FloatArray, timed: Callable[[FloatArray, FloatArray], FloatArray]
) -> JointTrajectory:
    """At rest at each corner (M, 6); `timed` finds the shares of a move, given points along it."""
    parts = []
    for start, goal in pairwise(corners_rad):
        length_rad = float(np.abs(goal - start).max())
        if length_rad < _SAME_RAD:
            continue
        shares = np.linspace(0, 1, max(int(length_rad / _PATH_RAD), _FEWEST_POINTS) + 1)
        samples = start + shares[:, None] * (goal - start)
        parts.append(JointTrajectory.of_samples(start + timed(shares, samples)[:, None] * (goal - start)))
    return JointTrajectory.joined(parts) if parts else JointTrajectory.at_rest(corners_rad[0], 0.0)


def timed_points(
    points: FloatArray,
    joints_rad: FloatArray,
    tool_points_m: FloatArray,
    limits: SpeedLimits,
    top_rate: FloatArray | None = None,
) -> FloatArray:
    """Return the parameters (N,) of a path every 8 ms, from rest at its first point to rest at its last.

    Time-optimal except for a small margin: the highest rate at each point that speed limits and curvature
    allow, then a forward and a backward pass for the accelerations (Bobrow et al. 1985).

    Args:
        points: (K,) parameters of the path, rising, in any unit.
        joints_rad: (K, 6) configurations there, close to each other.
        tool_points_m: (K, P, 3) the tool frame's origin there, and further points of the hand.
        limits: of joints and tool.
        top_rate: (K,) highest rate of the parameter per second; none if only the limits apply.
    """
    slopes = np.abs(np.gradient(joints_rad, points, axis=0))
    bends = np.abs(np.gradient(np.gradient(joints_rad, points, axis=0), points, axis=0))
    point_slopes = np.linalg.norm(np.gradient(tool_points_m, points, axis=0), axis=2)
    # never so fast that two samples are farther apart than what checks assume
    joint_speed = _SHARE * min(limits.joint_speed_rad_s, STEP_RAD / SAMPLE_S)
    tool_speed, point_speed = _SHARE * limits.tool_speed_m_s, _SHARE * STEP_M / SAMPLE_S
    acceleration = _SHARE * limits.joint_acceleration_rad_s2
    top = joint_speed / np.maximum(slopes.max(axis=1), _TINY)
    top = np.minimum(top, tool_speed / np.maximum(point_slopes[:, 0], _TINY))
    top = np.minimum(top, point_speed / np.maximum(point_slopes.max(axis=1), _TINY))
    # half of the acceleration is kept for changing the rate
    top = np.minimum(top, np.sqrt(0.5 * acceleration / np.maximum(bends.max(axis=1), _TINY)))
    if top_rate is not None:
        top = np.minimum(top, top_rate)
    rates = _reachable_rates(points, top, slopes, bends, acceleration)
    return _sample(points, rates)


def _reachable_rates(
    points: FloatArray, top: FloatArray, slopes: FloatArray, bends: FloatArray, acceleration: float
) -> FloatArray:
    """Rates (K,) at the points that can be reached from rest, and from which rest can be reached."""
    squares: list[float] = (top**2).tolist()
    squares[0] = squares[-1] = 0.0
    steps = (2 * np.diff(points)).tolist()
    joints = [list(zip(*pair, strict=True)) for pair in zip(slopes.tolist(), bends.tolist(), strict=True)]

    def gain(k: int) -> float:
        """How fast the rate may change at point `k`."""
        here = squares[k]
        gains: list[float] = [(acceleration - bend * here) / max(slope, _TINY) for slope, bend in joints[k]]
        return min(gains)

    last = len(squares) - 1
    for k in range(last):
        squares[k + 1] = min(squares[k + 1], squares[k] + steps[k] * gain(k))
    for k in range(last, 0, -1):
        squares[k - 1] = min(squares[k - 1], squares[k] + steps[k - 1] * gain(k))
    return np.array([sqrt(square) for square in squares])


def _sample(points: FloatArray, rates: FloatArray) -> FloatArray:
    """Parameters (N,) every 8 ms; the whole takes slightly longer so that it ends with a sample."""
    took = 2 * np.diff(points) / np.maximum(rates[:-1] + rates[1:], _TINY)
    times = np.concatenate([[0.0], np.cumsum(took)])
    n = max(ceil(times[-1] / SAMPLE_S - 1e-6), 1)
    ticks = np.linspace(0, times[-1], n + 1)
    k = np.clip(np.searchsorted(times, ticks, side="right") - 1, 0, len(took) - 1)
    since = ticks - times[k]
    gain = (rates[k + 1] - rates[k]) / np.maximum(took[k], _TINY)
    there = points[k] + since * (rates[k] + gain * since / 2)
    there[0], there[-1] = points[0], points[-1]
    return np.asarray(np.clip(there, points[k], points[k + 1]))
