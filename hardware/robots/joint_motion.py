"""Motions of the joints as functions of time: along straight segments, and along a timed trajectory."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import N_JOINTS, within_limits
from core.motion.trajectory import JointTrajectory
from hardware.errors import RobotError


def checked_path(arm: ArmModel, name: str, joints_rad: npt.ArrayLike) -> FloatArray:
    """Return joint configurations as (N, 6).

    Raises:
        RobotError: they are not configurations of this arm, which people call `name`, or beyond its limits.
    """
    path = np.array(joints_rad, dtype=float)
    is_path = path.ndim == 2 and len(path) > 0 and path.shape[1] == N_JOINTS
    if not is_path or not within_limits(arm, path).all():
        raise RobotError(f"The {name} cannot take these joint angles; plan the motion anew.")
    return path


@dataclass(frozen=True)
class Trapezoid:
    """A path from rest to rest.

    Attributes:
        length: of the path, in any unit.
        speed: highest, in that unit per second.
        acceleration: of speeding up and of slowing down.
    """

    length: float
    speed: float
    acceleration: float

    @property
    def top_speed(self) -> float:
        """What is really reached: short paths end before the highest speed."""
        return min(self.speed, sqrt(self.length * self.acceleration))

    @property
    def duration_s(self) -> float:
        """From rest to rest."""
        return 0.0 if self.length <= 0 else self.length / self.top_speed + self.top_speed / self.acceleration

    def at(self, time_s: float) -> tuple[float, float]:
        """Return the position and the speed at a time after the start."""
        if time_s >= self.duration_s or self.length <= 0:
            return self.length, 0.0
        ramp_s = self.top_speed / self.acceleration
        if time_s < ramp_s:
            return self.acceleration * max(time_s, 0.0) ** 2 / 2, self.acceleration * max(time_s, 0.0)
        left_s = self.duration_s - time_s
        if left_s < ramp_s:
            return self.length - self.acceleration * left_s**2 / 2, self.acceleration * left_s
        return self.top_speed * (time_s - ramp_s / 2), self.top_speed


class JointMotion:
    """Where the joints are, at any time after the start.

    Attributes:
        duration_s: until they rest at the last configuration.
        length_rad: how far the busiest joint turns in all.
    """

    def __init__(self, path_rad: FloatArray, speed_rad_s: float, acceleration_rad_s2: float) -> None:
        """Move along configurations (N, 6), the busiest joint of each segment at the given speed."""
        self._ends = list(pairwise(path_rad)) or [(path_rad[0], path_rad[0])]
        self._profiles = [
            Trapezoid(float(np.abs(end - start).max()), speed_rad_s, acceleration_rad_s2)
            for start, end in self._ends
        ]
        self.duration_s = sum(profile.duration_s for profile in self._profiles)
        # Summed as `at` does it: who waits for the end compares the two.
        self.length_rad = self.at(float("inf"))[2]

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints (6,), their speeds (6,), and how far the busiest has turned."""
        segment, before_s, done_rad = self._segment(time_s)
        start, end = self._ends[segment]
        profile = self._profiles[segment]
        position, speed = profile.at(time_s - before_s)
        direction = (end - start) / profile.length if profile.length else np.zeros(6)
        # The last configuration itself, not what rounding makes of it: a poll compares them.
        joints = end if position >= profile.length else start + position * direction
        return joints, speed * direction, done_rad + position

    def stopping(self, time_s: float) -> tuple[JointMotion, float]:
        """Return the motion that brakes from here to rest, and how much of it is over at this moment.

        It is the second half of a path that speeds up and slows down with the speed of now in its middle.
        """
        segment, before_s, _ = self._segment(time_s)
        start, end = self._ends[segment]
        profile = self._profiles[segment]
        position, speed = profile.at(time_s - before_s)
        if not speed:
            return JointMotion(self.at(time_s)[0][None], profile.speed, profile.acceleration), 0.0
        braking = speed**2 / (2 * profile.acceleration)
        direction = (end - start) / profile.length
        path = start + np.outer([position - braking, position + braking], direction)
        return JointMotion(path, profile.speed, profile.acceleration), speed / profile.acceleration

    def _segment(self, time_s: float) -> tuple[int, float, float]:
        """Index of the segment, when it begins, and how far the busiest joint turned before it."""
        before_s, done_rad = 0.0, 0.0
        for index, profile in enumerate(self._profiles[:-1]):
            if time_s < before_s + profile.duration_s:
                return index, before_s, done_rad
            before_s += profile.duration_s
            done_rad += profile.length
        return len(self._profiles) - 1, before_s, done_rad


_BRAKING_S = 0.1
_SLOPE_S = 1e-3


class TrajectoryMotion:
    """Where the joints are, at any time after the start.

    Attributes:
        duration_s: until they rest at the end.
        length_rad: what `at` returns at the end of the path, which is measured in seconds.
    """

    def __init__(
        self, trajectory: JointTrajectory, from_s: float = 0.0, until_s: float | None = None
    ) -> None:
        """Follow a trajectory; or, with `until_s`, slow down from its pace and come to rest there."""
        self._trajectory = trajectory
        self._from_s, self._until_s = from_s, until_s
        self.duration_s = trajectory.duration_s if until_s is None else 2 * (until_s - from_s)
        self.length_rad = trajectory.duration_s

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints (6,), their speeds (6,), and how far they have come."""
        clock_s, pace = self._clock(min(max(time_s, 0.0), self.duration_s))
        joints = self._trajectory.at(clock_s)
        if time_s >= self.duration_s:
            return joints, np.zeros(6), clock_s
        slope = (self._trajectory.at(clock_s + _SLOPE_S) - joints) / _SLOPE_S
        return joints, slope * pace, clock_s

    def stopping(self, time_s: float) -> tuple[TrajectoryMotion, float]:
        """Return the motion that brakes from here to rest, and how much of it is over at this moment."""
        if self._until_s is not None:
            return self, time_s
        until_s = min(time_s + _BRAKING_S / 2, self._trajectory.duration_s)
        return TrajectoryMotion(self._trajectory, time_s, until_s), 0.0

    def _clock(self, time_s: float) -> tuple[float, float]:
        """The trajectory's own time, and how fast it passes."""
        if self._until_s is None or self.duration_s <= 0:
            return self._from_s + time_s, 1.0
        pace = 1 - time_s / self.duration_s
        return self._from_s + time_s * (1 + pace) / 2, pace
