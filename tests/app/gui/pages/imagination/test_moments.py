import numpy as np
import pytest

from app.gui.pages.imagination.moments import Moments
from core.geometry import make_pose, rotation_x
from core.imagination.recording import Recording


@pytest.fixture
def recording():
    positions = np.array([[[0, 0, 1], [1, 0, 1]], [[0, 0, 0.5], [1, 0, 0.8]], [[0, 0, 0], [np.nan] * 3]])
    poses = np.array([np.eye(4), make_pose(rotation_x(0.02), [0, 0, 0.1]), np.eye(4)])
    times_s = np.array([0, 0.5, 1.0])
    quaternions = np.zeros((3, 2, 4))
    return Recording(*(array.astype(np.float32) for array in (times_s, positions, quaternions, poses)))


def test_recorded_moments_are_met_exactly(recording):
    moments = Moments(recording)
    assert moments.duration_s == 1.0
    for k, time_s in enumerate((0, 0.5, 1.0)):
        np.testing.assert_array_equal(moments.positions_m(time_s)[0], recording.positions_m[k, 0])
        np.testing.assert_allclose(moments.T_world_body(time_s), recording.T_world_body[k], atol=1e-7)


def test_between_moments_candies_and_body_are_between(recording):
    moments = Moments(recording)
    np.testing.assert_allclose(moments.positions_m(0.25), [[0, 0, 0.75], [1, 0, 0.9]], atol=1e-6)
    pose = moments.T_world_body(0.25)
    np.testing.assert_allclose(pose[:3, 3], [0, 0, 0.05], atol=1e-6)
    np.testing.assert_allclose(pose[:3, :3], rotation_x(0.01), atol=1e-4)


def test_a_candy_that_has_gone_is_not_seen_on_its_way(recording):
    assert np.isnan(Moments(recording).positions_m(0.75)[1]).all()


def test_before_and_after_it_stands_still(recording):
    moments = Moments(recording)
    np.testing.assert_array_equal(moments.positions_m(-1), recording.positions_m[0])
    np.testing.assert_array_equal(moments.positions_m(9)[0], recording.positions_m[2, 0])


def test_a_single_moment_is_a_recording_too(recording):
    alone = Recording(
        recording.time_s[:1], recording.positions_m[:1], recording.quaternions[:1], recording.T_world_body[:1]
    )
    np.testing.assert_array_equal(Moments(alone).positions_m(0.0), recording.positions_m[0])
