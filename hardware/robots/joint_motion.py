"""A joint move as a function of time: straight from configuration to configuration, standing at each."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from core.geometry import FloatArray
from hardware.robots.trapezoid import Trapezoid


class JointMotion:
    """Where the joints are, at any time after the start.

    Attributes:
        duration_s: until they stand at the last configuration.
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

        It is the second half of a way that speeds up and slows down with the speed of now in its middle.
        """
        segment, before_s, _ = self._segment(time_s)
        start, end = self._ends[segment]
        profile = self._profiles[segment]
        position, speed = profile.at(time_s - before_s)
        if not speed:
            return JointMotion(self.at(time_s)[0][None], profile.speed, profile.acceleration), 0.0
        braking = speed**2 / (2 * profile.acceleration)
        direction = (end - start) / profile.length
        way = start + np.outer([position - braking, position + braking], direction)
        return JointMotion(way, profile.speed, profile.acceleration), speed / profile.acceleration

    def _segment(self, time_s: float) -> tuple[int, float, float]:
        """Index of the segment, when it begins, and how far the busiest joint turned before it."""
        before_s, done_rad = 0.0, 0.0
        for index, profile in enumerate(self._profiles[:-1]):
            if time_s < before_s + profile.duration_s:
                return index, before_s, done_rad
            before_s += profile.duration_s
            done_rad += profile.length
        return len(self._profiles) - 1, before_s, done_rad
