"""A timed motion of the joints as the kinematic twin makes it, and how it stops on its way."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.motion.trajectory import JointTrajectory

_BRAKING_S = 0.1
_SLOPE_S = 1e-3


class TrajectoryMotion:
    """Where the joints are, at any time after the start.

    Attributes:
        duration_s: until they stand at the end.
        length_rad: what `at` tells at the end of the way; the way is counted in seconds.
    """

    def __init__(
        self, trajectory: JointTrajectory, from_s: float = 0.0, until_s: float | None = None
    ) -> None:
        """Follow a trajectory; or, with `until_s`, slow down from its pace and stand there, on its way."""
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
