"""The search: optuna proposes values, somebody judges them, the best are kept.

One trial after the other, so that the same seed gives the same trials however many workers judge them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from core.errors import Cancelled
from core.evaluation.fitting.fitted import FittedParameter
from core.evaluation.fitting.trials import FitResult, FitStep, FitTrial, S

if TYPE_CHECKING:
    import optuna

_FEWEST_FOR_IMPORTANCE = 8
_GOOD_SHARE = 0.25
"""Importance tells what distinguishes this share of the trials, the best, from all others."""
_STARTUP = 10
"""Trials at random before the search learns from them."""

Judge = Callable[[int, Mapping[str, float], "FitTrial[S] | None"], S]
"""Judges (number of the trial, values, best so far or none)."""


def search(
    fitted: Sequence[FittedParameter],
    start: Mapping[str, float],
    judge: Judge[S],
    n_trials: int,
    seed: int,
    tell: Callable[[FitStep[S]], None],
) -> FitResult[S]:
    """Try values, those to start from first; without a parameter to fit that is the only trial.

    Args:
        fitted: parameters and their ranges.
        start: values to begin with; one outside its range is tried all the same.
        judge: says what values are worth; may raise `Cancelled`.
        n_trials: at least one.
        seed: of the search.
        tell: told after each trial.

    Raises:
        Cancelled: somebody asked to stop before the first trial was done.
    """
    proposer = _Proposer(fitted, seed)
    done: list[FitTrial[S]] = []
    best: FitTrial[S] | None = None
    n_trials = n_trials if fitted else 1
    is_cut_short = False
    for number in range(n_trials):
        values = dict(start) if number == 0 else proposer.propose()
        try:
            trial = FitTrial(number, values, judge(number, values, best))
        except Cancelled:
            if best is None:
                raise
            is_cut_short = True
            break
        done.append(trial)
        if number == 0:
            proposer.begin_with(values, trial.score.objective)
        else:
            proposer.learn(trial.score.objective)
        if best is None or (not trial.score.is_given_up and trial.score.rank > best.score.rank):
            best = trial
        tell(FitStep(trial, best, n_trials, proposer.importance()))
    if best is None:
        raise ValueError("a search needs at least one trial")
    return FitResult(
        done[0],
        best,
        n_trials,
        len(done),
        sum(trial.score.is_given_up for trial in done),
        seed,
        proposer.importance(),
        is_cut_short,
    )


class _Proposer:
    """An optuna study that is asked and told by hand; optuna is imported here and nowhere else."""

    def __init__(self, fitted: Sequence[FittedParameter], seed: int) -> None:
        import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._fitted = {one.name: one for one in fitted}
        self._ranges: dict[str, Any] = {
            one.name: optuna.distributions.FloatDistribution(one.low, one.high, log=one.is_log)
            for one in fitted
        }
        sampler = optuna.samplers.TPESampler(n_startup_trials=_STARTUP, multivariate=True, seed=seed)
        self._study: optuna.Study = optuna.create_study(sampler=sampler, direction="maximize")

    def begin_with(self, values: Mapping[str, float], objective: float) -> None:
        """Take in what the values to start from are worth; outside the ranges they teach nothing."""
        import optuna

        if all(one.holds(values[name]) for name, one in self._fitted.items()):
            told = optuna.trial.create_trial(params=dict(values), distributions=self._ranges, value=objective)
            self._study.add_trial(told)

    def propose(self) -> dict[str, float]:
        """Return values to try; `learn` must follow before the next ones."""
        self._asked = self._study.ask(self._ranges)
        asked = self._asked.params
        return {name: one.rounded(float(asked[name])) for name, one in self._fitted.items()}

    def learn(self, objective: float) -> None:
        """Take in what the proposed values are worth."""
        self._study.tell(self._asked, objective)

    def importance(self) -> dict[str, float]:
        """Return shares that add up to one, the largest first; empty if there are too few trials."""
        from optuna.importance import PedAnovaImportanceEvaluator, get_param_importances

        trials = self._study.get_trials(deepcopy=False)
        if len(trials) < _FEWEST_FOR_IMPORTANCE:
            return {}
        evaluator = PedAnovaImportanceEvaluator(target_quantile=_GOOD_SHARE)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # that trials of equal worth tell nothing is seen
            return dict(get_param_importances(self._study, evaluator=evaluator))
