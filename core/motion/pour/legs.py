"""From a way of the tool frame, or of the joints, to a trajectory every 8 ms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.inverse_kinematics import inverse_kinematics
from core.motion.kinematics import TURN_RAD
from core.motion.pour.scene import PourScene
from core.motion.pour.timing import SpeedLimits, timed_places
from core.motion.trajectory import SAMPLE_S, JointTrajectory

Poses = Callable[[FloatArray], FloatArray]
"""From places (N,) along a way to `T_base_grasp` (N, 4, 4)."""
_PLACE_RAD, _PLACE_M = np.radians(0.5), 0.0025
_FEWEST_PLACES = 16
_SAME_RAD = 1e-9
_MOST_STEP_RAD = np.radians(5.0)
"""No joint turns more between two places; ten times as much as the hand."""
_TRIES = 5
_ROOM = 1.02
"""A way is timed again, this much below its limit, where its bends turn out sharper between its places."""


@dataclass(frozen=True)
class ToolLeg:
    """A smooth way of the tool frame on one branch of the inverse kinematics, from rest to rest.

    Attributes:
        poses: of the tool frame at places along the way.
        places: (K,) rising, so near to each other that slopes and bends can be told from them.
        top_rate: (K,) highest rate in places per second, or none.
    """

    poses: Poses
    places: FloatArray
    top_rate: FloatArray | None = None

    @classmethod
    def of_length(cls, poses: Poses, length_m: float, turn_rad: float) -> ToolLeg:
        """A way with places from 0 to 1, which moves and turns by about this much."""
        n = max(int(length_m / _PLACE_M), int(turn_rad / _PLACE_RAD), _FEWEST_PLACES)
        return cls(poses, np.linspace(0, 1, n + 1))

    def trajectory(
        self, scene: PourScene, branch: int, start_rad: FloatArray, limits: SpeedLimits
    ) -> JointTrajectory:
        """Follow it from the configuration (6,) at its beginning.

        Raises:
            MotionError: a place is out of reach, or the way passes a singular configuration.
        """
        poses = self.poses(self.places)
        joints = continued(branch_joints(scene, branch, poses), start_rad)
        if np.abs(np.diff(joints, axis=0)).max() > _MOST_STEP_RAD:
            raise MotionError("Between two places the arm would fling round a singular configuration.")
        points = scene.hand_points(poses)
        slower = limits
        for _ in range(_TRIES):
            places = timed_places(self.places, joints, points, slower, self.top_rate)
            exact = branch_joints(scene, branch, self.poses(places))
            near = np.stack([np.interp(places, self.places, column) for column in joints.T], axis=1)
            result = trajectory_of(exact + TURN_RAD * np.round((near - exact) / TURN_RAD))
            excess = acceleration_rad_s2(result) / limits.joint_acceleration_rad_s2
            if excess <= 1:
                return result
            slower = slower.with_acceleration(slower.joint_acceleration_rad_s2 / (excess * _ROOM))
        raise MotionError("The arm would have to follow a bend that is too sharp for it.")


def branch_joints(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> FloatArray:
    """Configurations (N, 6) on a branch for poses (N, 4, 4) of the tool frame, each within half a turn.

    Raises:
        MotionError: a pose is out of reach.
    """
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(T_base_grasp), (branch,))
    if not result.found.all() or result.undetermined.any():
        raise MotionError("The arm cannot follow the way of the hand; it is out of reach.")
    return result.joints_rad[:, 0]


def continued(joints_rad: FloatArray, start_rad: FloatArray) -> FloatArray:
    """Turn configurations (N, 6) of a way by whole turns so that it goes on evenly from (6,)."""
    whole = np.unwrap(joints_rad, axis=0)
    return np.asarray(whole + TURN_RAD * np.round((start_rad - whole[0]) / TURN_RAD))


def joint_trajectory(scene: PourScene, corners_rad: FloatArray, limits: SpeedLimits) -> JointTrajectory:
    """Straight joint moves through configurations (M, 6), at rest at each."""
    parts = []
    for start, goal in pairwise(corners_rad):
        length_rad = float(np.abs(goal - start).max())
        if length_rad < _SAME_RAD:
            continue
        shares = np.linspace(0, 1, max(int(length_rad / _PLACE_RAD), _FEWEST_PLACES) + 1)
        samples = start + shares[:, None] * (goal - start)
        points = scene.hand_points(scene.grasp_poses(samples))
        places = timed_places(shares, samples, points, limits)
        parts.append(trajectory_of(start + places[:, None] * (goal - start)))
    return joined(parts) if parts else standing(corners_rad[0], 0.0)


def trajectory_of(joints_rad: FloatArray) -> JointTrajectory:
    """A trajectory with a sample (N, 6) every 8 ms."""
    return JointTrajectory(sample_times_s(len(joints_rad)), joints_rad)


def sample_times_s(n: int) -> FloatArray:
    """When `n` samples are, every 8 ms from 0."""
    times: FloatArray = SAMPLE_S * np.arange(n, dtype=float)
    return times


def joined(parts: Sequence[JointTrajectory]) -> JointTrajectory:
    """One after the other."""
    first, *others = (part.joints_rad for part in parts)
    return trajectory_of(np.concatenate([first, *(joints[1:] for joints in others)]))


def standing(joints_rad: FloatArray, time_s: float) -> JointTrajectory:
    """Stand still, at least this long."""
    n = max(int(np.ceil(time_s / SAMPLE_S - 1e-6)), 1)
    return trajectory_of(np.tile(joints_rad, (n + 1, 1)))


def acceleration_rad_s2(trajectory: JointTrajectory) -> float:
    """The largest acceleration of any joint, at rest before and after."""
    steps = np.diff(trajectory.joints_rad, axis=0, prepend=trajectory.start_rad[None])
    steps = np.concatenate([steps, np.zeros((1, steps.shape[1]))])
    return float(np.abs(np.diff(steps, axis=0)).max() / SAMPLE_S**2)
