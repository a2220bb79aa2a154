"""Which parameters can be fitted, and what is refused with a sentence."""

import pytest

from core.errors import InputError
from core.evaluation.fitting.fitted import (
    CONTAINABILITY,
    POURING,
    ROLLING,
    SPINNING,
    fitted_parameters,
    parameters_of_trial,
    settings_of,
    start_values,
    threshold_name,
)
from core.parameters import Parameters, apply_settings, flatten


@pytest.mark.parametrize("names", [CONTAINABILITY, POURING])
def test_the_usual_ranges_are_possible(names):
    for one in fitted_parameters((), names):
        for bound in (one.low, one.high):
            assert parameters_of_trial(Parameters(), (one,), 1, {one.name: bound}), one.name


def test_spinning_follows_rolling_unless_it_is_named():
    (tied,) = fitted_parameters([ROLLING])
    assert settings_of((tied,), {ROLLING: 0.3}) == {ROLLING: 0.3, SPINNING: 0.3}
    separate = fitted_parameters([ROLLING, SPINNING])
    assert all(one.tied == () for one in separate)


def test_the_first_trial_is_as_it_was_tied_or_not():
    start = apply_settings(Parameters(), {ROLLING: 0.1, SPINNING: 0.3})
    (tied,) = fitted_parameters([ROLLING])
    assert parameters_of_trial(start, (tied,), 0, {ROLLING: 0.1}) == start
    assert flatten(parameters_of_trial(start, (tied,), 1, {ROLLING: 0.1}))[SPINNING] == 0.1


def test_a_range_is_taken_and_kept_to():
    (one,) = fitted_parameters(["containability.contact.lateral_friction=0.01:0.2"])
    assert (one.low, one.high, one.is_log) == (0.01, 0.2, True)
    assert not fitted_parameters(["containability.contact.lateral_friction=0:0.2"])[0].is_log
    assert one.rounded(0.123456) == 0.1235 and one.rounded(0.20000001) == 0.2


def test_values_come_from_and_go_to_parameters():
    fitted = fitted_parameters(["containability.rotation_rad", ROLLING])
    start = start_values(fitted, Parameters())
    assert parameters_of_trial(Parameters(), fitted[:1], 1, start) == Parameters()
    changed = parameters_of_trial(
        Parameters(), fitted, 1, {"containability.rotation_rad": 0.1, ROLLING: 0.25}
    )
    assert flatten(changed)[SPINNING] == 0.25


@pytest.mark.parametrize(
    ("verdict", "name"),
    [("omega", "containability.omega_threshold"), ("capacity", "containability.capacity_threshold")],
)
def test_the_verdict_says_which_threshold_is_chosen(verdict, name):
    parameters = apply_settings(Parameters(), {"containability.verdict": verdict, name: 0.625})
    assert threshold_name(parameters) == name
    assert parameters.containability.deciding_threshold == 0.625


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("containability.rotation_rat", "did you mean 'containability.rotation_rad'"),
        ("containability.omega_threshold", "always chosen"),
        ("containability.capacity_threshold", "always chosen"),
        ("containability.verdict", "no real number"),
        ("reconstruction.voxel_m", "cannot be fitted: labels depend on"),
        ("particle.shape", "no real number"),
        ("containability.n_max", "no real number"),
        ("containability.rotation_rad=0.1", "write NAME=LOW:HIGH"),
        ("containability.rotation_rad=a:b", "write NAME=LOW:HIGH"),
        ("containability.rotation_rad=0.2:0.1", "LOW must be below HIGH"),
        ("containability.rotation_rad=0.1:9", "is not possible"),
        ("containability.rotation_rad=nan:1", "LOW must be below HIGH"),
    ],
)
def test_what_cannot_be_fitted(text, said):
    with pytest.raises(InputError, match=said):
        fitted_parameters([text])


def test_named_twice():
    with pytest.raises(InputError, match="fitted twice"):
        fitted_parameters([ROLLING, f"{ROLLING}=0.1:0.2"])
