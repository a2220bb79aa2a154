"""The search: optuna proposes values, somebody judges them, the best are kept.

One trial after the other, so that the same seed gives the same trials however many workers judge them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from core.errors import Cancelled
from core.evaluation.fitting.fitted import FittedParameter
from core.progress import Reporter

if TYPE_CHECKING:
    import optuna

_FEWEST_FOR_IMPORTANCE = 8
_GOOD_SHARE = 0.25
"""Importance is what distinguishes this share of the trials, the best, from all others."""
_STARTUP = 10
"""Trials at random before the search learns from them."""


class TrialScore(Protocol):
    """What a trial is worth."""

    @property
    def rank(self) -> tuple[float, ...]:
        """Decides which of two trials is better: the larger one."""

    @property
    def objective(self) -> float:
        """What the search maximises."""

    @property
    def is_given_up(self) -> bool:
        """Whether the trial was ended early because it could not become the best."""


S = TypeVar("S", bound=TrialScore)


@dataclass(frozen=True)
class FitTrial(Generic[S]):
    """One set of values that was tried.

    Attributes:
        number: from 0, which has the values to start from.
        values: by the names of the fitted parameters.
        score: what they are worth.
    """

    number: int
    values: Mapping[str, float]
    score: S


@dataclass(frozen=True)
class FitStep(Generic[S]):
    """Reported after each trial.

    Attributes:
        trial: that is done now.
        best: so far.
        n_trials: in all.
        importance: share of each fitted parameter in the differences between trials; empty as long as there
            are too few.
    """

    trial: FitTrial[S]
    best: FitTrial[S]
    n_trials: int
    importance: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_best(self) -> bool:
        """Whether this trial is the best one so far."""
        return self.trial.number == self.best.number


@dataclass(frozen=True)
class FitResult(Generic[S]):
    """What a search ends with.

    Attributes:
        start: the trial with the values to start from.
        best: of all trials; never worse than the start.
        n_trials: that were requested.
        n_done: that were done.
        n_given_up: of these, ended early.
        sampler_seed: of the search.
        importance: as in `FitStep`.
        is_cut_short: whether somebody asked to stop.
    """

    start: FitTrial[S]
    best: FitTrial[S]
    n_trials: int
    n_done: int
    n_given_up: int
    sampler_seed: int
    importance: Mapping[str, float]
    is_cut_short: bool

    def to_table(self) -> dict[str, Any]:
        """Return how the search went as plain JSON, without values and scores."""
        return {
            "sampler": "optuna TPE",
            "sampler_seed": self.sampler_seed,
            "trials": self.n_trials,
            "done": self.n_done,
            "given_up": self.n_given_up,
            "best": self.best.number,
            "is_cut_short": self.is_cut_short,
        }


Judge = Callable[[int, Mapping[str, float], "FitTrial[S] | None"], S]
"""Judges (number of the trial, values, best so far or none)."""


def search(
    fitted: Sequence[FittedParameter],
    start: Mapping[str, float],
    judge: Judge[S],
    n_trials: int,
    seed: int,
    report: Callable[[FitStep[S]], None],
) -> FitResult[S]:
    """Try values, those to start from first; without a parameter to fit that is the only trial.

    Args:
        fitted: parameters and their ranges.
        start: values to begin with; one outside its range is tried all the same.
        judge: says what values are worth; may raise `Cancelled`.
        n_trials: at least one.
        seed: of the search.
        report: called after each trial.

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
        report(FitStep(trial, best, n_trials, proposer.importance()))
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
    """An optuna study, driven step by step; optuna is imported here and nowhere else."""

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
            trial = optuna.trial.create_trial(
                params=dict(values), distributions=self._ranges, value=objective
            )
            self._study.add_trial(trial)

    def propose(self) -> dict[str, float]:
        """Return values to try; `learn` must follow before the next ones."""
        self._proposed = self._study.ask(self._ranges)
        values = self._proposed.params
        return {name: one.rounded(float(values[name])) for name, one in self._fitted.items()}

    def learn(self, objective: float) -> None:
        """Take in what the proposed values are worth."""
        self._study.tell(self._proposed, objective)

    def importance(self) -> dict[str, float]:
        """Return shares that add up to one, the largest first; empty if there are too few trials."""
        from optuna.importance import PedAnovaImportanceEvaluator, get_param_importances

        trials = self._study.get_trials(deepcopy=False)
        if len(trials) < _FEWEST_FOR_IMPORTANCE:
            return {}
        evaluator = PedAnovaImportanceEvaluator(target_quantile=_GOOD_SHARE)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # trials of equal worth: seen in the result
            return dict(get_param_importances(self._study, evaluator=evaluator))


class PartReporter(Reporter):
    """Reports a part's progress as that of a longer work."""

    def __init__(self, whole: Reporter, stage: str, begun: float, size: float, total: float) -> None:
        """The part goes from `begun` to `begun + size` of `total`, in the whole's stage."""
        super().__init__()
        self._whole = whole
        self._stage = stage
        self._begun = begun
        self._size = size
        self._total = total

    def progress(self, stage: str, done: float, total: float) -> None:  # noqa: ARG002
        """Report it as the whole's."""
        share = done / total if total else 1.0
        self._whole.progress(self._stage, self._begun + self._size * share, self._total)

    def warn(self, sentence: str) -> None:
        """Pass it on."""
        self._whole.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Ask the whole."""
        self._whole.raise_if_cancelled()
