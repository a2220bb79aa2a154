"""Joint moves as functions of time: within speed and acceleration, exact at the end, smooth when stopped."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from core.geometry import FloatArray
from hardware.robots.joint_motion import JointMotion, Trapezoid

SPEED, ACCELERATION = 0.8, 1.2
SLACK = 1e-9

angle = st.floats(-6.2, 6.2).map(lambda value: round(value, 4))
joints = st.tuples(*[angle] * 6)
paths = st.lists(joints, min_size=2, max_size=5).map(np.array)


def sampled(motion: JointMotion, samples: int = 400) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Time step, joints (N, 6), speeds (N, 6) and turned angles (N,)."""
    times = np.linspace(0, motion.duration_s, samples)
    at = [motion.at(time) for time in times]
    return float(times[1]), *(np.array([one[k] for one in at]) for k in range(3))  # type: ignore[return-value]


@settings(max_examples=60, deadline=None)
@given(paths)
@example(np.array([[0.0] * 6, [0.01] * 6]))
@example(np.array([[0.0] * 6, [0.0] * 6, [3.0, 0, 0, 0, 0, -1]]))
def test_speed_and_acceleration_stay_within_their_limits(path: FloatArray) -> None:
    motion = JointMotion(path, SPEED, ACCELERATION)
    np.testing.assert_array_equal(motion.at(0.0)[0], path[0])
    np.testing.assert_allclose(motion.at(motion.duration_s)[0], path[-1], atol=1e-12)
    np.testing.assert_array_equal(motion.at(motion.duration_s + 1e-6)[0], path[-1])
    np.testing.assert_array_equal(motion.at(motion.duration_s + 1e-6)[1], 0)
    if not motion.duration_s:
        return
    step, joints_rad, speeds, turned = sampled(motion)
    assert np.abs(speeds).max() <= SPEED + SLACK
    assert np.abs(np.diff(joints_rad, axis=0)).max() <= SPEED * step + SLACK
    assert np.abs(np.diff(speeds, axis=0)).max() <= ACCELERATION * step + SLACK
    assert (np.diff(turned) >= -SLACK).all()
    # What it says of its speed is how fast it really goes.
    middle = (speeds[1:] + speeds[:-1]) / 2
    assert np.abs(np.diff(joints_rad, axis=0) / step - middle).max() <= ACCELERATION * step + SLACK


@settings(max_examples=100, deadline=None)
@given(paths, st.floats(0, 1))
def test_stopping_goes_on_smoothly_along_the_way_and_ends_in_time(path: FloatArray, share: float) -> None:
    motion = JointMotion(path, SPEED, ACCELERATION)
    time = share * motion.duration_s
    before, speeds, _ = motion.at(time)
    braking, elapsed = motion.stopping(time)
    now, now_speeds, _ = braking.at(elapsed)
    np.testing.assert_allclose(now, before, atol=1e-7)
    np.testing.assert_allclose(now_speeds, speeds, atol=1e-6)
    takes = braking.duration_s - elapsed
    assert takes <= SPEED / ACCELERATION + 1e-6
    for moment in np.linspace(0, takes, 20):
        later, later_speeds, _ = braking.at(elapsed + moment)
        assert np.abs(later - before).max() <= np.abs(speeds).max() * moment + 1e-7
        assert np.abs(later_speeds).max() <= np.abs(speeds).max() + 1e-6
    rest, rest_speeds, _ = braking.at(braking.duration_s + 1e-6)
    assert not rest_speeds.any()
    distance = np.abs(speeds).max() ** 2 / (2 * ACCELERATION)
    assert np.abs(rest - before).max() == pytest.approx(distance, abs=1e-6)


@settings(max_examples=60, deadline=None)
@given(paths)
def test_a_motion_that_is_over_is_all_done(path: FloatArray) -> None:
    motion = JointMotion(path, SPEED, ACCELERATION)
    assert motion.at(float("inf"))[2] == motion.length_rad


@pytest.mark.parametrize(
    ("length", "duration"),
    [(0.8 * 3 + 0.8**2 / 1.2, 3 + 2 * 0.8 / 1.2), (0.12, 2 * (0.12 / 1.2) ** 0.5), (0.0, 0.0)],
    ids=["trapezoid", "triangle", "nothing"],
)
def test_how_long_it_takes(length: float, duration: float) -> None:
    profile = Trapezoid(length, SPEED, ACCELERATION)
    assert profile.duration_s == pytest.approx(duration)
    assert profile.at(profile.duration_s) == (length, 0.0)
    assert profile.at(duration / 2)[0] == pytest.approx(length / 2)
