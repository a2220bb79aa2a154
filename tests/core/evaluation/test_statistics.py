"""Figures of a few trials, each counted by hand; intervals against published values and their equation."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from core.evaluation.evaluation import EvaluatedObject
from core.evaluation.outputs import summary_of
from core.evaluation.statistics import (
    CapacityFigures,
    Confusion,
    Figures,
    Margin,
    Share,
    agreement_of,
    auc_interval,
    capacity_figures,
    sets_of,
    stage_times,
)
from core.evaluation.tables import figures_of, text_tables
from core.evaluation.trials import Trial
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


def test_what_cannot_be_told_is_not_right_and_no_failure_either() -> None:
    trials = [
        held("mug", "container", 0.6),
        held("vase", "container", 0.02, unseen_ml=300.0),
        held("pipe", "non-container", 0.4, unseen_ml=40.0, spilled=(), in_cup=()),
        held("block", "non-container", 0.0),
    ]
    found = Figures.of(trials, N_POURS)
    assert found.confusion == Confusion(1, 0, 1, 0, 0, undecided=2)
    assert found.accuracy == Share(2, 4)
    assert [one.predicted for one in trials] == ["container", "cannot tell", "cannot tell", "non-container"]
    assert [one.is_right for one in trials] == [True, False, False, True]


def test_a_right_refusal_counts_nowhere_and_a_wrong_one_as_spilled() -> None:
    doubted = {"clean_at_least": 0.3, "wanted_clean": 0.6}
    trials = [
        trial("mug", "container", 80, clean_at_least=0.8, wanted_clean=0.6),
        trial("egg cup", "container", 80, spilled=(4, 0, 9), in_cup=(0, 0, 0), **doubted),
        trial("bowl", "container", 80, spilled=(0, 0, 1), in_cup=(0, 0, 0), **doubted),
    ]
    found = Figures.of(trials, N_POURS)
    assert found.declined == Share(1, 2), "2 of 3 pours into the bowl were clean, more than wanted"
    assert found.pours == Share(3, 6)
    assert found.clean_objects == Share(1, 2)
    assert Figures.of([replace(trials[1], wanted_clean=None)], N_POURS).pours == Share(1, 3)


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
    assert (method.margin, method.threshold) == (Margin((0.08, "tray"), (0.02, "can")), 0.1)
    assert (omega.margin, omega.threshold) == (Margin((0.1, "tray"), (0.12, "can")), 0.05)
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
    assert Figures.of([failed, held("mug", "container", 0.5)], 1).threshold == 0.1
    assert Figures.of([failed], 1).threshold == 0.13


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


@pytest.mark.parametrize(
    ("count", "n", "low", "high"),
    [  # Newcombe (1998), Table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_as_published(count: int, n: int, low: float, high: float) -> None:
    assert Share(count, n).interval == pytest.approx((low, high), abs=6e-5)


def test_the_papers_shares_and_nothing_of_nothing() -> None:
    assert round(100 * (Share(54, 55).value or 0), 2) == 98.18
    assert round(100 * (Share(125, 130).value or 0), 2) == 96.15
    assert (Share(0, 0).value, Share(0, 0).interval) == (None, None)
    assert Share(7, 7).interval is not None and Share(7, 7).interval[1] == 1.0
    assert Share(0, 7).interval is not None and Share(0, 7).interval[0] == 0.0


@pytest.mark.parametrize(
    ("auc", "n_containers", "n_others"),
    [(0.8932, 51, 58), (1.0, 19, 22), (0.5, 5, 9), (0.0, 4, 4), (0.99, 2, 30)],
)
def test_the_aucs_interval_solves_its_equation(auc: float, n_containers: int, n_others: int) -> None:
    bound = Polynomial([0, 1])
    spare, square = (n_containers + n_others) / 2 - 1, 1.959963984540054**2
    both = (2 - bound) * (1 + bound)
    variance = bound * (1 - bound) * (both + spare * ((1 - bound) * (1 + bound) + bound * (2 - bound)))
    roots = ((bound - auc) ** 2 * both * (n_containers * n_others) - square * variance).roots()
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-7])
    inside = real[(real > -1e-6) & (real < 1 + 1e-6)]
    assert auc_interval(auc, n_containers, n_others) == pytest.approx((inside[0], inside[-1]), abs=1e-6)


def test_a_perfect_auc_of_few_objects_is_not_certain() -> None:
    few, many = auc_interval(1.0, 5, 5), auc_interval(1.0, 50, 50)
    assert few[1] == many[1] == 1.0
    assert few[0] < many[0] < 1.0


def test_how_true_the_capacities_are() -> None:
    def measured(name: str, ml: float, least_ml: float | None, most_ml: float | None) -> Trial:
        bounds = {"capacity_least_ml": least_ml, "capacity_most_ml": most_ml}
        return held(name, "container", 0.5, capacity_ml=ml, **bounds)

    trials = (
        *(measured("mug", 95.0, 90.0, 101.0), measured("bowl", 80.0, 78.0, 90.0)),
        *(measured("cup", 99.0, None, None), measured("unknown", 50.0, 40.0, 60.0)),
        *(measured("vase", 60.0, 58.0, None), measured("urn", 120.0, 110.0, None)),
        held("can", "non-container", 0.0, capacity_ml=100.0),
    )
    known = {"mug": 100.0, "bowl": 100.0, "cup": 100.0, "can": 0.0, "vase": 100.0, "urn": 100.0}
    objects = tuple(EvaluatedObject(one.name, one.label, capacity_ml=known.get(one.name)) for one in trials)
    evaluation = evaluation_of(*trials, objects=objects)
    assert capacity_figures(evaluation, "imagination") == CapacityFigures(Share(2, 5), Share(2, 4))
    said = "capacity within 10 % of the true one: 2 of 5; the true one lies within the stated bounds: 2 of 4."
    assert said in " ".join(text_tables(evaluation).split())
    assert summary_of(evaluation)["capacity"]["within_bounds"]["count"] == 2
    nowhere = replace(evaluation, objects=tuple(replace(one, capacity_ml=None) for one in objects))
    assert capacity_figures(nowhere, "imagination") is None
    assert summary_of(nowhere)["capacity"] is None
