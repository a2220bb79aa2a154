from __future__ import annotations

import numpy as np
import pytest

from core.geometry import make_pose, rotation_x, transform_points
from core.imagination.recording import Recorder
from core.imagination.rendering.replay import make_replay, poured_in, standing

CANDY_M = np.array([0.007, 0.007, 0.004])


def test_lost_candies_lie_where_they_passed_the_ground(story):
    recording = story.containability.recording
    replay = make_replay(recording, story.containability.retained, 0.1, np.array([0, 0, 0.004]))
    shown = replay.recording.positions_m
    assert np.isfinite(shown[-1]).all()
    np.testing.assert_allclose(shown[-1, :5, 2], 0.102, atol=1e-6)
    np.testing.assert_allclose(shown[-1, :5, :2], recording.positions_m[0, :5, :2], atol=1e-6)
    np.testing.assert_array_equal(shown[:, 5:], recording.positions_m[:, 5:])
    assert (shown[..., 2] >= 0.102 - 1e-6).all()
    assert np.isnan(recording.positions_m[-1, :5]).all()  # the recording itself is left alone


def test_a_candy_goes_on_as_it_flew_and_one_not_yet_poured_stays_hidden():
    recorder = Recorder(2)
    for time_s, x, z in ((0.0, 0.0, 0.3), (0.1, 0.1, 0.2), (0.2, np.nan, np.nan)):
        recorder.add(time_s, np.array([[x, 0, z, 0, 0, 0, 1], [np.nan] * 7]), np.eye(4))
    replay = make_replay(recorder.recording(), np.zeros(2, dtype=bool), 0.0, np.zeros(3))
    np.testing.assert_allclose(replay.recording.positions_m[2, 0], [0.3, 0, 0], atol=1e-6)
    assert np.isnan(replay.recording.positions_m[:, 1]).all()


@pytest.mark.parametrize("counted", ["inside", "above_floor"])
def test_candies_are_coloured_by_the_rule_they_were_counted_by(story, counted):
    assert (
        poured_in(story.grid.recordings[0][0], story.containability.aabb_m, counted).tolist()
        == story.containability.retained.tolist()
    )


def test_a_candy_left_in_the_cup_is_above_the_floor_but_not_inside(story):
    recorder = Recorder(1)
    recorder.add(0.0, np.array([[0, 0, 1.0, 0, 0, 0, 1]]), np.eye(4))
    aabb = story.containability.aabb_m
    assert not poured_in(recorder.recording(), aabb, "inside")[0]
    assert poured_in(recorder.recording(), aabb, "above_floor")[0]


def test_candies_that_fall_on_one_place_lie_side_by_side():
    recorder = Recorder(4)
    for time_s, height_m in ((0.0, 0.3), (0.1, 0.1), (0.2, -0.1)):
        recorder.add(time_s, np.tile([0, 0, height_m, 0, 0, 0, 1.0], (4, 1)), np.eye(4))
    shown = make_replay(recorder.recording(), np.zeros(4, dtype=bool), 0.0, CANDY_M).recording.positions_m
    gaps = np.linalg.norm(shown[-1, :, None, :2] - shown[-1, None, :, :2], axis=2)
    assert gaps[np.triu_indices(4, 1)].min() >= 0.00699


def test_an_object_that_is_tilted_stands_on_its_ground_with_its_candies(story):
    poses = [np.eye(4), make_pose(rotation_x(0.2), [0, 0, 0]), np.eye(4)]
    recorder = Recorder(1)
    for k, pose in enumerate(poses):
        recorder.add(float(k), np.array([[0, 0, 0.2, 0, 0, 0, 1]]), pose)
    shown, ground_m = standing(recorder.recording(), story.surface)
    assert ground_m == pytest.approx(story.surface.aabb_min_m[2], abs=1e-6)
    for pose in shown.T_world_body:
        heights = transform_points(pose.astype(float), story.surface.vertices_m)[:, 2]
        assert heights.min() == pytest.approx(ground_m, abs=1e-6)
    raised_m = shown.positions_m[:, 0, 2] - 0.2
    assert raised_m == pytest.approx(shown.T_world_body[:, 2, 3], abs=1e-6)
    assert raised_m[0] == raised_m[2] == 0
