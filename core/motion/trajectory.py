"""A timed motion of the joints: what is checked is this, and what the robot follows is this."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray

SAMPLE_S = 0.008
"""Time between two samples of a trajectory that a robot shall follow: the cycle of a CB3 controller."""


@dataclass(frozen=True)
class JointTrajectory:
    """Where the joints are at which time; straight between the samples, at rest at both ends.

    Attributes:
        times_s: (N,) strictly rising from 0, N at least 2.
        joints_rad: (N, 6).
    """

    times_s: FloatArray
    joints_rad: FloatArray

    @property
    def duration_s(self) -> float:
        """From rest to rest."""
        return float(self.times_s[-1])

    @property
    def start_rad(self) -> FloatArray:
        """(6,) where the arm must stand to begin."""
        return np.asarray(self.joints_rad[0])

    @property
    def end_rad(self) -> FloatArray:
        """(6,) where it stands in the end."""
        return np.asarray(self.joints_rad[-1])

    def at(self, time_s: float) -> FloatArray:
        """Return the joints (6,) at a time; the ends before and after."""
        return np.array([np.interp(time_s, self.times_s, column) for column in self.joints_rad.T])

    def reversed(self) -> JointTrajectory:
        """Return the way back, in the same time."""
        return JointTrajectory(self.duration_s - self.times_s[::-1], self.joints_rad[::-1])
