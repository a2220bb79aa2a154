"""What a search tells of itself: one trial after the other, the best so far, and what it ends with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar


class Score(Protocol):
    """What a trial was worth."""

    @property
    def rank(self) -> tuple[float, ...]:
        """Decides which of two trials is better: the larger one."""

    @property
    def objective(self) -> float:
        """What the search maximises."""

    @property
    def is_given_up(self) -> bool:
        """Whether the trial was ended early because it could not become the best."""


S = TypeVar("S", bound=Score)


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
    """Told after each trial.

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
        n_trials: that were asked for.
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
