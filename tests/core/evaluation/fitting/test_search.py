"""The search finds what is best, gives up what is hopeless, and depends on nothing but its seed."""

import dataclasses
from types import SimpleNamespace

import pytest

from core.errors import Cancelled, InputError, StageError, WorkerError
from core.evaluation.fitting.containability import FitRequest, fit
from core.evaluation.fitting.fitted import fitted_parameters
from core.evaluation.fitting.search import search
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere, WorkerPool
from tests.core.evaluation.fitting.made_up import (
    BEST_ROTATION_RAD,
    FRICTION,
    ROTATION,
    START,
    cases,
    made_up_score,
    refusing_score,
)


def request(n_trials=30, seed=0, names=(ROTATION, FRICTION), **start):
    parameters = apply_settings(Parameters(), START | start)
    fitted = fitted_parameters(names) if names else ()
    return FitRequest(parameters, fitted, n_trials, seed)


def run(wanted, runner=None, reporter=None, judge=made_up_score, seeds=(0, 1, 2)):
    steps = []
    result = fit(cases(seeds), wanted, runner or RunHere(), reporter or Reporter(), steps.append, judge)
    return result, steps


def test_it_finds_the_margin_and_never_ends_worse_than_it_began():
    result, steps = run(request(40))
    assert result.start.values == pytest.approx(START)
    assert result.best.score.margin > 0.55 > result.start.score.margin
    assert result.best.values[ROTATION] == pytest.approx(BEST_ROTATION_RAD, abs=0.04)
    assert result.best.score.is_separating and result.best.score.accuracy() == 1
    assert [step.trial.number for step in steps] == list(range(40))
    margins = [step.best.score.margin for step in steps]
    assert margins == sorted(margins)


def test_the_best_start_stays_the_best():
    result, _ = run(request(12, **{ROTATION: BEST_ROTATION_RAD, FRICTION: 0.05}))
    assert result.best.number == 0


def test_a_start_outside_the_range_is_tried_and_proposals_stay_inside():
    wanted = request(12, names=(f"{ROTATION}=0.1:0.12", FRICTION))
    result, steps = run(wanted)
    assert result.start.values[ROTATION] == START[ROTATION]
    assert all(0.1 <= step.trial.values[ROTATION] <= 0.12 for step in steps[1:])


def test_hopeless_trials_are_given_up_and_told_as_such():
    result, steps = run(request(30))
    given_up = [step.trial for step in steps if step.trial.score.is_given_up]
    assert result.n_given_up == len(given_up) > 0
    for step in steps:
        n_scores = len(step.trial.score.scores)
        assert (n_scores < 12) == step.trial.score.is_given_up
        assert not step.best.score.is_given_up


def test_the_number_of_workers_changes_nothing():
    wanted = request(14)
    here, steps_here = run(wanted)
    with WorkerPool(2) as pool:
        there, steps_there = run(wanted, pool)
    assert (here, steps_here) == (there, steps_there)


def test_another_seed_makes_other_trials():
    searches = [[step.trial.values for step in run(request(3, seed))[1]] for seed in (0, 1)]
    assert searches[0][0] == searches[1][0]
    assert searches[0][1] != searches[1][1]


def test_importance_comes_with_enough_trials_and_names_what_matters():
    def judge(_number, values, _best):
        rank = (-abs(values[ROTATION] - 0.2),)
        return SimpleNamespace(rank=rank, objective=rank[0], is_given_up=False)

    steps = []
    search(fitted_parameters((ROTATION, FRICTION)), START, judge, 24, 0, steps.append)
    assert steps[6].importance == {}
    found = steps[-1].importance
    assert set(found) == {ROTATION, FRICTION}
    assert sum(found.values()) == pytest.approx(1)
    assert found[ROTATION] > 0.8


def test_where_nothing_matters_the_search_goes_on():
    """Every trial is worth the same: importance has no answer, and the start stays."""
    same = SimpleNamespace(rank=(0.0,), objective=0.0, is_given_up=False)
    steps = []
    result = search(fitted_parameters((ROTATION, FRICTION)), START, lambda *_: same, 12, 0, steps.append)
    assert result.best.number == 0 and len(steps) == 12
    assert all(share >= 0 for share in result.importance.values())


class StopsAfter(Reporter):
    """Asks to stop once a trial is under way."""

    def __init__(self, n_trials):
        super().__init__()
        self.n_trials = n_trials
        self.shares = []

    def progress(self, stage, done, total):
        self.shares.append((stage, done / total))
        if done >= self.n_trials:
            self.cancel()


def test_a_cancelled_fit_keeps_the_best():
    reporter = StopsAfter(5.2)
    result, steps = run(request(30), reporter=reporter)
    assert result.is_cut_short and 5 <= result.n_done == len(steps) < 10
    assert result.best == steps[-1].best
    shares = [share for _, share in reporter.shares]
    assert shares == sorted(shares) and {stage for stage, _ in reporter.shares} == {"fitting"}


def test_cancelled_before_the_first_trial_there_is_nothing():
    with pytest.raises(Cancelled):
        run(request(30), reporter=StopsAfter(0))


def test_without_a_parameter_only_the_threshold_is_chosen():
    result, steps = run(request(30, names=()))
    assert len(steps) == result.n_trials == 1
    assert result.best.values == {}
    assert result.best.score.largest_other.score < result.best.score.threshold


def test_values_an_object_cannot_be_judged_with_are_no_good():
    result, steps = run(request(15, **{FRICTION: 0.05}), judge=refusing_score)
    assert result.best.values[ROTATION] <= 0.1
    assert any(step.trial.score.smallest_container.score == 0 for step in steps)


def test_a_start_that_an_object_cannot_be_judged_with_is_refused():
    with pytest.raises(StageError, match="'mug' cannot be judged with the parameters to start from"):
        run(request(5, **{ROTATION: 0.2}), judge=refusing_score)


def test_cases_of_one_kind_cannot_be_fitted_to():
    mugs = [case for case in cases() if case.is_container]
    with pytest.raises(InputError, match="without a single object that is no container"):
        fit(mugs, request(), RunHere(), Reporter(), print)
    uneven = mugs + [dataclasses.replace(one, is_container=False, seed=9) for one in mugs]
    with pytest.raises(InputError, match="only objects of one kind"):
        fit(uneven, request(), RunHere(), Reporter(), print)


class DiesOnce(RunHere):
    """Loses a worker in the second call."""

    def __init__(self):
        self.calls = 0

    def run(self, tasks, stage, reporter):
        self.calls += 1
        if self.calls == 2:
            raise WorkerError("A worker died.")
        return super().run(tasks, stage, reporter)


def test_a_worker_that_dies_costs_only_time():
    assert run(request(6), DiesOnce())[0] == run(request(6))[0]
