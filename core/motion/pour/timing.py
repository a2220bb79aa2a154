"""How fast to go along a way: as fast as every limit allows, from rest to rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, inf, sqrt

import numpy as np

from core.geometry import FloatArray
from core.motion.joint_path import STEP_RAD
from core.motion.pour.settings import MotionSettings
from core.motion.trajectory import SAMPLE_S

STEP_M = 0.005
"""The tool moves no farther between two samples of a trajectory."""
_SHARE = 0.97
"""Of each limit: the rest is for what lies between the places of a way."""
_TINY = 1e-9


@dataclass(frozen=True)
class SpeedLimits:
    """What holds along a way.

    Attributes:
        joint_speed_rad_s: of every joint.
        joint_acceleration_rad_s2: of every joint.
        tool_speed_m_s: of the tool frame's origin; inf for none.
    """

    joint_speed_rad_s: float
    joint_acceleration_rad_s2: float
    tool_speed_m_s: float

    @classmethod
    def on_the_way(cls, limits: MotionSettings) -> SpeedLimits:
        """Outside of the turn that pours."""
        return cls(limits.joint_speed_rad_s, limits.joint_acceleration_rad_s2, limits.tool_speed_m_s)

    @classmethod
    def in_the_turn(cls, limits: MotionSettings) -> SpeedLimits:
        """In the turn that pours, and back."""
        return cls(limits.pour_joint_speed_rad_s, limits.pour_acceleration_rad_s2, inf)

    def with_acceleration(self, acceleration_rad_s2: float) -> SpeedLimits:
        """The same with another acceleration."""
        return replace(self, joint_acceleration_rad_s2=acceleration_rad_s2)


def timed_places(
    places: FloatArray,
    joints_rad: FloatArray,
    points_m: FloatArray,
    limits: SpeedLimits,
    top_rate: FloatArray | None = None,
) -> FloatArray:
    """Return at which place (N,) of a way to be every 8 ms: at the first one at rest, at the last one at
    rest.

    Time-optimal but for a little margin: the highest rate at each place that speed limits and curvature
    allow, then a pass forward and one backward for the accelerations (Bobrow et al. 1985).

    Args:
        places: (K,) rising, in any unit.
        joints_rad: (K, 6) configurations at the places, near to each other.
        points_m: (K, P, 3) the tool frame's origin there, and further points of the hand.
        limits: of joints and tool.
        top_rate: (K,) highest rate in places per second; none if nothing but the limits counts.
    """
    slopes = np.abs(np.gradient(joints_rad, places, axis=0))
    bends = np.abs(np.gradient(np.gradient(joints_rad, places, axis=0), places, axis=0))
    point_slopes = np.linalg.norm(np.gradient(points_m, places, axis=0), axis=2)
    # never so fast that two samples are farther apart than what was checked between
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
    rates = _reachable_rates(places, top, slopes, bends, acceleration)
    return _sample(places, rates)


def _reachable_rates(
    places: FloatArray, top: FloatArray, slopes: FloatArray, bends: FloatArray, acceleration: float
) -> FloatArray:
    """Rates (K,) at the places that can be reached from rest, and from which rest can be reached."""
    squares: list[float] = (top**2).tolist()
    squares[0] = squares[-1] = 0.0
    steps = (2 * np.diff(places)).tolist()
    joints = [list(zip(*pair, strict=True)) for pair in zip(slopes.tolist(), bends.tolist(), strict=True)]

    def gain(k: int) -> float:
        """How fast the rate may change at place `k`."""
        here = squares[k]
        gains: list[float] = [(acceleration - bend * here) / max(slope, _TINY) for slope, bend in joints[k]]
        return min(gains)

    last = len(squares) - 1
    for k in range(last):
        squares[k + 1] = min(squares[k + 1], squares[k] + steps[k] * gain(k))
    for k in range(last, 0, -1):
        squares[k - 1] = min(squares[k - 1], squares[k] + steps[k - 1] * gain(k))
    return np.array([sqrt(square) for square in squares])


def _sample(places: FloatArray, rates: FloatArray) -> FloatArray:
    """Places (N,) every 8 ms; the whole takes a little longer so that it ends with a sample."""
    took = 2 * np.diff(places) / np.maximum(rates[:-1] + rates[1:], _TINY)
    times = np.concatenate([[0.0], np.cumsum(took)])
    n = max(ceil(times[-1] / SAMPLE_S - 1e-6), 1)
    ticks = np.linspace(0, times[-1], n + 1)
    k = np.clip(np.searchsorted(times, ticks, side="right") - 1, 0, len(took) - 1)
    since = ticks - times[k]
    gain = (rates[k + 1] - rates[k]) / np.maximum(took[k], _TINY)
    there = places[k] + since * (rates[k] + gain * since / 2)
    there[0], there[-1] = places[0], places[-1]
    return np.asarray(np.clip(there, places[k], places[k + 1]))
