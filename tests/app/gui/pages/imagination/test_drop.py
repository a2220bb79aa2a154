import json

import numpy as np
import pytest

from app.gui.pages.imagination.drop import Moments, key_of, load, phases_of, push_of
from core.errors import SessionError
from core.geometry import make_pose, rotation_x, transform_points
from core.imagination.recording import Recording
from core.parameters import Parameters
from core.pipeline.session_view import SessionView
from core.session import Session


@pytest.fixture
def mug_drop(mug_session):
    return load(key_of(SessionView.of(mug_session)))


def test_the_phases_are_those_of_the_imagination(mug_drop):
    """As `core.imagination.perturbation` moves the object."""
    from core.imagination.perturbation import Perturbation

    perturbation = Perturbation(mug_drop.settings, np.zeros(3))
    phases = {phase.key: phase for phase in mug_drop.phases}
    assert [*phases] == ["drop", "tilt_x", "tilt_y", "push"]
    assert phases["push"].end_s == pytest.approx(perturbation.duration_s)
    for key, column in (("tilt_x", 0), ("tilt_y", 1)):
        middle = perturbation.at((phases[key].begin_s + phases[key].end_s) / 2)
        assert np.argmax(np.abs(middle.angular_velocity_rad_s)) == column
    assert not perturbation.at(phases["drop"].end_s - 0.01).angular_velocity_rad_s.any()
    for share, direction in ((0.1, "+x"), (0.3, "-x"), (0.6, "+y"), (0.9, "-y")):
        since_s = share * (phases["push"].end_s - phases["push"].begin_s)
        gravity = perturbation.at(phases["push"].begin_s + since_s).gravity_m_s2
        assert push_of(mug_drop.settings, since_s) == direction
        assert np.sign(gravity["xy".index(direction[1])]) == (1 if direction[0] == "+" else -1)


def test_the_last_phase_leaves_those_that_stayed(mug_drop):
    assert mug_drop.phases[-1].n_inside == mug_drop.containability.n_in


def test_phases_without_time_are_left_out(mug_drop):
    settings = Parameters().containability.model_copy(update={"rotation_s": 0.0})
    assert [phase.key for phase in phases_of(mug_drop.drop, settings)] == ["drop", "push"]


def test_lost_candies_lie_on_the_ground_and_kept_ones_in_the_object(mug_drop):
    kept = mug_drop.containability.retained
    ends_m = mug_drop.moments.positions_m(mug_drop.moments.duration_s)
    low_m, high_m = mug_drop.containability.aabb_m
    assert ((ends_m[kept] > low_m) & (ends_m[kept] < high_m)).all()
    assert np.isfinite(ends_m).all()
    lying = ends_m[~kept, 2] - mug_drop.ground_m
    assert np.median(lying) == pytest.approx(mug_drop.candy[0][:, 2].max(), abs=1e-4)
    diameter_m = np.ptp(mug_drop.candy[0][:, 0])
    apart_m = np.linalg.norm(ends_m[~kept, None, :2] - ends_m[None, ~kept, :2], axis=2)
    assert apart_m[np.triu_indices(len(apart_m), 1)].min() > 0.99 * diameter_m


def test_the_object_stands_on_the_ground_however_it_is_tilted(mug_drop):
    vertices_m = mug_drop.body.vertices_m.astype(float)
    for time_s in np.linspace(0, mug_drop.moments.duration_s, 25):
        lowest_m = transform_points(mug_drop.moments.T_world_body(time_s), vertices_m)[:, 2].min()
        assert lowest_m == pytest.approx(mug_drop.ground_m, abs=5e-4)


def test_the_parameters_shown_are_those_of_its_run_not_of_the_next(mug_drop):
    assert mug_drop.settings.n_max == 150
    assert mug_drop.seed == 0
    assert len(mug_drop.indents_m) == 3
    assert mug_drop.outline_m[:, 0].max() <= mug_drop.containability.aabb_m[1, 0] + 1e-6


def test_candies_on_a_flat_top_are_distinguished_from_fallen_ones(block_session):
    drop = load(key_of(SessionView.of(block_session)))
    assert drop.containability.n_in == 0
    assert 0 < drop.n_on_top < 30
    assert drop.indents_m == ()


def test_nothing_imagined_is_nothing_to_show(tmp_path):
    session = Session.create_or_open(tmp_path / "new")
    assert load(key_of(SessionView(session))) is None


@pytest.mark.parametrize("group", ["containability", "particle"])
def test_a_result_of_another_version_is_explained(mug_session, group):
    path = mug_session / "containability" / "record.json"
    record = json.loads(path.read_text())
    record["parameters"][group] = {"of_the_future": 1}
    path.write_text(json.dumps(record))
    with pytest.raises(SessionError, match="another version"):
        load(key_of(SessionView.of(mug_session)))


def test_a_damaged_result_is_explained(mug_session):
    np.savez(mug_session / "containability" / "drop.npz", time_s=np.zeros(1))
    with pytest.raises(SessionError, match="is damaged"):
        load(key_of(SessionView.of(mug_session)))


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


def test_before_and_after_it_is_at_rest(recording):
    moments = Moments(recording)
    np.testing.assert_array_equal(moments.positions_m(-1), recording.positions_m[0])
    np.testing.assert_array_equal(moments.positions_m(9)[0], recording.positions_m[2, 0])


def test_a_single_moment_is_a_recording_too(recording):
    alone = Recording(
        recording.time_s[:1], recording.positions_m[:1], recording.quaternions[:1], recording.T_world_body[:1]
    )
    np.testing.assert_array_equal(Moments(alone).positions_m(0.0), recording.positions_m[0])
