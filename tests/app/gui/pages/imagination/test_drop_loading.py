import json

import numpy as np
import pytest

from app.gui.pages.imagination.loading import key_of, load
from app.gui.pages.imagination.phases import phases_of, push_of
from core.errors import SessionError
from core.parameters import Parameters
from core.session import Session


@pytest.fixture
def mug_drop(mug_session):
    return load(key_of(Session.open(mug_session)))


def test_the_phases_are_those_of_the_imagination(mug_drop):
    """As `core.imagination.perturbation` moves the object."""
    from core.imagination.perturbation import Perturbation

    perturbation = Perturbation(mug_drop.settings, np.zeros(3))
    phases = {phase.key: phase for phase in mug_drop.phases}
    assert [*phases] == ["drop", "tilt_x", "tilt_y", "shove"]
    assert phases["shove"].end_s == pytest.approx(perturbation.duration_s)
    for key, column in (("tilt_x", 0), ("tilt_y", 1)):
        middle = perturbation.at((phases[key].begin_s + phases[key].end_s) / 2)
        assert np.argmax(np.abs(middle.angular_velocity_rad_s)) == column
    assert not perturbation.at(phases["drop"].end_s - 0.01).angular_velocity_rad_s.any()
    for share, direction in ((0.1, "+x"), (0.3, "-x"), (0.6, "+y"), (0.9, "-y")):
        since_s = share * (phases["shove"].end_s - phases["shove"].begin_s)
        gravity = perturbation.at(phases["shove"].begin_s + since_s).gravity_m_s2
        assert push_of(mug_drop.settings, since_s) == direction
        assert np.sign(gravity["xy".index(direction[1])]) == (1 if direction[0] == "+" else -1)


def test_the_last_phase_leaves_those_that_stayed(mug_drop):
    assert mug_drop.phases[-1].n_inside == mug_drop.containability.n_in


def test_phases_without_time_are_left_out(mug_drop):
    settings = Parameters().containability.model_copy(update={"rotation_s": 0.0})
    assert [phase.key for phase in phases_of(mug_drop.containability, settings)] == ["drop", "shove"]


def test_lost_candies_lie_on_the_ground_and_kept_ones_in_the_object(mug_drop):
    kept = mug_drop.containability.retained
    ends_m = mug_drop.moments.positions_m(mug_drop.moments.duration_s)
    low_m, high_m = mug_drop.containability.aabb_m
    assert ((ends_m[kept] > low_m) & (ends_m[kept] < high_m)).all()
    assert np.isfinite(ends_m).all()
    lying = ends_m[~kept, 2] - mug_drop.ground_m
    assert np.median(lying) == pytest.approx(mug_drop.candy_radius_m, abs=1e-4)
    assert mug_drop.ground_m < low_m[2]


def test_it_is_told_by_the_parameters_of_its_run_not_by_those_of_the_next(mug_drop):
    assert mug_drop.settings.n_max == 150
    assert mug_drop.seed == 0
    assert len(mug_drop.indents_m) == 3
    assert mug_drop.outline_m[:, 0].max() <= mug_drop.containability.aabb_m[1, 0] + 1e-6


def test_candies_on_a_flat_top_are_told_from_fallen_ones(block_session):
    drop = load(key_of(Session.open(block_session)))
    assert drop.containability.n_in == 0
    assert 0 < drop.n_on_top < 30
    assert drop.indents_m == ()


def test_nothing_imagined_is_nothing_to_show(tmp_path):
    session = Session.create_or_open(tmp_path / "new")
    assert load(key_of(session)) is None


@pytest.mark.parametrize("group", ["containability", "particle"])
def test_a_result_of_another_version_is_explained(mug_session, group):
    path = mug_session / "containability" / "record.json"
    record = json.loads(path.read_text())
    record["parameters"][group] = {"of_the_future": 1}
    path.write_text(json.dumps(record))
    with pytest.raises(SessionError, match="another version"):
        load(key_of(Session.open(mug_session)))


def test_a_damaged_result_is_explained(mug_session):
    np.savez(mug_session / "containability" / "drop.npz", time_s=np.zeros(1))
    with pytest.raises(SessionError, match="imagine it again"):
        load(key_of(Session.open(mug_session)))
