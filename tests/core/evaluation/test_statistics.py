"""Figures of a few trials, each counted by hand."""

from dataclasses import replace

import pytest

from core.evaluation.evaluation import EvaluatedObject
from core.evaluation.intervals import Share
from core.evaluation.statistics import Confusion, Figures, Margin, agreement_of, sets_of, stage_times
from core.evaluation.tables import figures_of
from tests.core.evaluation.evaluations import (
    N_POURS,
    evaluation_of,
    held,
    small_evaluation,
    trial,
    two_measures,
)


@pytest.fixture
def small() -> Figures:
    return Figures.of(small_evaluation().trials, N_POURS)


def test_what_failed_is_not_right_and_the_ambiguous_do_not_count(small: Figures) -> None:
    assert small.confusion == Confusion(3, 1, 4, 1, 1)
    assert small.accuracy == Share(7, 10)
    assert "tissue <box>" not in small.names


def test_auc_by_hand(small: Figures) -> None:
    # tray 8 lies above 0, 0, 2, level with 8, below 24; mug, bowl and vase lie above all five
    assert small.auc == pytest.approx((3 * 5 + 3 + 0.5) / (4 * 5))


def test_auc_at_its_ends() -> None:
    level = [trial("a", "container", 10), trial("b", "non-container", 10)]
    assert Figures.of(level, 1).auc == 0.5
    assert Figures.of([replace(level[0], n_in=11), level[1]], 1).auc == 1.0
    assert Figures.of([replace(level[0], n_in=9), level[1]], 1).auc == 0.0
    assert Figures.of(level[:1], 1).auc is None
    assert Figures.of(level[:1], 1).roc == () and Figures.of([], 1).margin.value is None


def test_a_container_that_was_not_poured_into_fails_in_all_its_pours(small: Figures) -> None:
    # mug and vase 3 of 3, bowl 2 of 3, tray (misjudged) and bucket (failed) 0 of 3
    assert small.pours == Share(8, 15)
    assert small.clean_objects == Share(2, 5)
    assert [one.name for one in small.stray_pours] == ["can"]


def test_without_pours_there_is_no_success() -> None:
    found = Figures.of([trial("mug", "container", 80, spilled=())], 0)
    assert found.pours == found.clean_objects == Share(0, 0)


def test_a_problem_after_the_judgement_spoils_the_pours_alone() -> None:
    found = Figures.of([trial("mug", "container", 80, spilled=(), problem="The cup is too small.")], 3)
    assert (found.accuracy, found.pours) == (Share(1, 1), Share(0, 3))


def test_the_score_is_what_judges() -> None:
    method, omega = (figures_of(two_measures(), variant) for variant in ("imagination", "omega"))
    assert method.confusion == Confusion(1, 0, 2, 1, 0) and omega.confusion == Confusion(2, 1, 1, 0, 0)
    assert (method.measure, omega.measure) == ("Capacity share", "Omega")
    # 0.51 and 0.08 above 0.02 and 0; by Omega the tray with 0.1 lies below the can with 0.12
    assert (method.auc, omega.auc) == (1.0, 0.75)
    assert method.margin == Margin((0.08, "tray"), (0.02, "can"), 0.1, "Capacity share")
    assert omega.margin == Margin((0.1, "tray"), (0.12, "can"), 0.05, "Omega")
    assert method.of_seed(0) == method
    assert method.roc[:3] == ((0, 0), (0, 0.5), (0, 1))


def test_a_trial_knows_what_judges_it() -> None:
    can = held("can", "non-container", 0.02, n_in=150)
    assert (can.omega, can.score, can.measure, can.is_judged_container) == (
        0.75,
        0.02,
        "Capacity share",
        False,
    )
    level = held("cup", "container", 0.1)
    assert level.is_judged_container is False, "the threshold itself is not above it"
    nothing = held("ball", "non-container", 0.0)
    assert (nothing.score, nothing.measure, nothing.is_right) == (0.0, "Capacity share", True)
    failed = trial("mug", "container", None)
    assert (failed.score, failed.is_judged_container) == (None, None)


def test_a_set_in_which_all_failed_has_the_measure_of_its_variant() -> None:
    found = evaluation_of(held("mug", "container", 0.5), trial("jar", "container", None, threshold=0.1))
    assert figures_of(found, "imagination", frozenset({"jar"})).measure == "Capacity share"


def test_what_failed_does_not_tell_the_threshold() -> None:
    failed = trial("jar", "container", None, threshold=0.13)
    assert Figures.of([failed, held("mug", "container", 0.5)], 1).margin.threshold == 0.1
    assert Figures.of([failed], 1).margin.threshold == 0.13


def test_ambiguous_objects_tell_the_measure_too() -> None:
    assert Figures.of([held("box", "ambiguous", 0.3)], 1).measure == "Capacity share"


def test_margins_name_the_objects(small: Figures) -> None:
    margin = small.margin
    assert margin.smallest_container == (0.04, "tray") and margin.largest_other == (0.12, "can")
    assert margin.value == pytest.approx(-0.08)


def test_an_object_is_right_if_it_is_with_every_seed() -> None:
    trials = [trial("mug", "container", n, seed=seed) for seed, n in enumerate((80, 5))]
    found = Figures.of([*trials, trial("ball", "non-container", 0)], 3)
    assert (found.accuracy, found.right_objects) == (Share(2, 3), Share(1, 2))
    assert [found.of_seed(seed).accuracy for seed in found.seeds] == [Share(2, 2), Share(0, 1)]
    assert found.clean_objects == Share(0, 1), "with the second seed it was not poured into"


def test_the_roc_curve_runs_from_corner_to_corner_and_over_the_auc(small: Figures) -> None:
    x, y = zip(*small.roc, strict=True)
    assert (x[0], y[0]) == (0, 0) and (x[-1], y[-1]) == (1, 1)
    area = sum((x[k + 1] - x[k]) * (y[k + 1] + y[k]) / 2 for k in range(len(x) - 1))
    assert area == pytest.approx(small.auc)


def test_the_others_are_those_nothing_was_fitted_to() -> None:
    objects = [EvaluatedObject(name, "container") for name in "abc"]
    assert set(sets_of(objects)) == {"all"}
    marked = [replace(objects[0], is_calibration=True), replace(objects[1], is_restricted=True), objects[2]]
    assert sets_of(marked) == {
        "all": {"a", "b", "c"},
        "restricted": {"b"},
        "calibration": {"a"},
        "other": {"b", "c"},
    }
    assert "other" not in sets_of(marked[:1])


def test_seconds_by_stage() -> None:
    took = stage_times(trial("a", "container", 9, seconds={"scan": s}) for s in (1.0, 2.0, 6.0))["scan"]
    assert (took.n, took.mean_s, took.median_s, took.max_s) == (3, 3.0, 2.0, 6.0)


def test_agreement_of_the_people_asked() -> None:
    votes = ((5, 5), (0, 5), (4, 5), (2, 5))
    objects = [
        EvaluatedObject(str(k), "container", n_container=n, n_asked=m) for k, (n, m) in enumerate(votes)
    ]
    found = agreement_of(objects)
    assert found is not None
    assert found.mean_share == pytest.approx((1 + 1 + 0.8 + 0.6) / 4)
    assert list(found.n_objects.items()) == [((5, 5), 2), ((4, 5), 1), ((3, 5), 1)]
    assert agreement_of([EvaluatedObject("a", "container")]) is None
