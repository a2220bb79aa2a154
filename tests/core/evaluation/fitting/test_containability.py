"""What is fitted is what decides: capacity share or Omega, of real imagination on analytic bodies."""

import pytest

from core.collision import from_parts
from core.evaluation.fitting.containability import FitCase, FitRequest, fit, score_of
from core.evaluation.fitting.fitted import threshold_name
from core.imagination.drop import imagine_drop
from core.imagination.judgement import judge
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere
from tests.core.evaluation.few_candies import FEW_CANDIES
from tests.core.imagination.conftest import box
from tests.core.imagination.here import here

DISH_ML, DISH_HULL_ML = 70 * 50 * 25 / 1000, 80 * 60 * 30 / 1000
SLAB_ML, SLAB_HULL_ML = 70 * 50 * 8 / 1000, 80 * 60 * 60 / 1000


def hollow(height_m, depth_m):
    """A block of 80 x 60 mm with a hollow between walls of 5 mm."""
    low, top = height_m - depth_m, height_m
    return from_parts(
        (
            box((0, 0, 0), (0.08, 0.06, low)),
            box((0, 0, low), (0.005, 0.06, top)),
            box((0.075, 0, low), (0.08, 0.06, top)),
            box((0, 0, low), (0.08, 0.005, top)),
            box((0, 0.055, low), (0.08, 0.06, top)),
        )
    )


@pytest.fixture(scope="module")
def cases():
    """A dish, and a block with a hollow as deep as a candy: some stay in it, but hardly any of it is room."""
    return (
        FitCase("dish", True, 3, hollow(0.03, 0.025)),
        FitCase("slab", False, 3, hollow(0.06, 0.008)),
        FitCase("block", False, 3, from_parts((box((0, 0, 0), (0.08, 0.06, 0.03)),))),
    )


def fitted(cases, verdict):
    parameters = apply_settings(Parameters(), FEW_CANDIES | {"containability.verdict": verdict})
    found = fit(cases, FitRequest(parameters, (), 1), RunHere(), Reporter(), lambda _: None)
    return parameters, found.best.score


def test_a_threshold_between_the_capacity_shares_is_found(cases):
    parameters, score = fitted(cases, "capacity")
    dish, slab, block = (one.score for one in score.scores)
    assert dish == pytest.approx(DISH_ML / DISH_HULL_ML, rel=0.35)
    assert 0 < slab < 2 * SLAB_ML / SLAB_HULL_ML
    assert block == 0, "nothing stays on it in the drop"
    assert score.largest_other.name == "slab"
    assert slab < score.threshold < dish
    assert threshold_name(parameters) == "containability.capacity_threshold"


def test_by_omega_another_threshold_is_found(cases):
    parameters, score = fitted(cases, "omega")
    dish, slab, block = (one.score for one in score.scores)
    assert threshold_name(parameters) == "containability.omega_threshold"
    assert dish == imagine_drop(here(parameters), cases[0].model).omega
    assert slab > dish / 2, "a layer of candies stays in either: Omega does not ask how deep it is"
    assert block == 0


def test_the_score_is_the_verdicts_capacity_share(cases):
    parameters = apply_settings(
        Parameters(),
        FEW_CANDIES
        | {"containability.verdict": "capacity", "holding.n_load": 3, "holding.tilt_step_rad": 0.25},
    )
    model = cases[1].model
    context = here(parameters)
    judged = judge(context, model, imagine_drop(context, model))
    assert score_of(cases[1], parameters) == judged.verdict.capacity_share
