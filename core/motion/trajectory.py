"""A timed motion of the joints: exactly what is checked is what the robot follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from core.geometry import FloatArray

SAMPLE_S = 0.008
"""Time between two samples of a trajectory for a robot: the cycle of a CB3 controller."""


@dataclass(frozen=True)
class JointTrajectory:
    """Joint positions over time; linear between the samples, at rest at both ends.

    Attributes:
        times_s: (N,) strictly rising from 0, N at least 2.
        joints_rad: (N, 6).
    """

    times_s: FloatArray
    joints_rad: FloatArray

    @classmethod
    def of_samples(cls, joints_rad: FloatArray) -> JointTrajectory:
        """A trajectory with a sample (N, 6) every 8 ms."""
        return cls(SAMPLE_S * np.arange(len(joints_rad), dtype=float), joints_rad)

    @classmethod
    def at_rest(cls, joints_rad: FloatArray, time_s: float) -> JointTrajectory:
        """Rest at a configuration (6,) for at least this long."""
        n = max(ceil(time_s / SAMPLE_S - 1e-6), 1)
        return cls.of_samples(np.tile(joints_rad, (n + 1, 1)))

    @classmethod
    def joined(cls, parts: Sequence[JointTrajectory]) -> JointTrajectory:
        """Trajectories of samples every 8 ms, one after the other."""
        first, *others = (part.joints_rad for part in parts)
        return cls.of_samples(np.concatenate([first, *(joints[1:] for joints in others)]))

    @property
    def duration_s(self) -> float:
        """From rest to rest."""
        return float(self.times_s[-1])

    @property
    def start_rad(self) -> FloatArray:
        """(6,) where the arm must be at the start."""
        return np.asarray(self.joints_rad[0])

    @property
    def end_rad(self) -> FloatArray:
        """(6,) where it is at the end."""
        return np.asarray(self.joints_rad[-1])

    @property
    def peak_acceleration_rad_s2(self) -> float:
        """Largest acceleration of any joint, for samples every 8 ms, at rest before and after."""
        steps = np.diff(self.joints_rad, axis=0, prepend=self.start_rad[None])
        steps = np.concatenate([steps, np.zeros((1, steps.shape[1]))])
        return float(np.abs(np.diff(steps, axis=0)).max() / SAMPLE_S**2)

    def at(self, time_s: float) -> FloatArray:
        """Return the joints (6,) at a time; the ends before and after."""
        return np.array([np.interp(time_s, self.times_s, column) for column in self.joints_rad.T])

    def reversed(self) -> JointTrajectory:
        """Return the same motion backwards, in the same time."""
        return JointTrajectory(self.duration_s - self.times_s[::-1], self.joints_rad[::-1])
