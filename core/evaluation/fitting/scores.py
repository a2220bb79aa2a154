"""What a set of values is worth: by how much containers score more than other objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

_DIGITS = 4
_MEAN_WEIGHT = 0.01
"""Of the mean distance in the objective: it ranks equal margins and gives the search a slope where the
margin has none (all containers empty, say), and never outweighs a difference of margins above 0.02."""


@dataclass(frozen=True)
class CaseScore:
    """The score of one object with one seed: its capacity share or its Omega, whichever judges."""

    name: str
    is_container: bool
    seed: int
    score: float


@dataclass(frozen=True)
class FitScore:
    """The scores of all cases, or of those that were judged before the trial was given up.

    Attributes:
        scores: containers and others, at least one of each.
        is_given_up: whether the other cases could not have made it the best any more.
    """

    scores: tuple[CaseScore, ...]
    is_given_up: bool = False

    @cached_property
    def smallest_container(self) -> CaseScore:
        """The container's case with the smallest score; of equal ones the first by name and seed."""
        return min(
            (one for one in self.scores if one.is_container), key=lambda one: (one.score, *_place(one))
        )

    @cached_property
    def largest_other(self) -> CaseScore:
        """Another object's case with the largest score; of equal ones the first by name and seed."""
        others = (one for one in self.scores if not one.is_container)
        return min(others, key=lambda one: (-one.score, *_place(one)))

    @property
    def margin(self) -> float:
        """How far every container stays above every other object; negative where they overlap."""
        return self.smallest_container.score - self.largest_other.score

    @property
    def mean_distance(self) -> float:
        """How far containers lie above other objects on average."""
        return float(np.mean(self._values(True)) - np.mean(self._values(False)))

    @property
    def rank(self) -> tuple[float, float]:
        """What decides which of two is better: the margin, and among equals the mean distance."""
        return self.margin, self.mean_distance

    @property
    def objective(self) -> float:
        """What the search maximises: the margin, and a hundredth of the mean distance."""
        return self.margin + _MEAN_WEIGHT * self.mean_distance

    @property
    def is_separating(self) -> bool:
        """Whether a threshold judges all cases rightly."""
        return self.margin > 0

    @cached_property
    def threshold(self) -> float:
        """The threshold that fits (`best_threshold`)."""
        return best_threshold(self._values(True), self._values(False))

    def accuracy(self, threshold: float | None = None) -> float:
        """Return the share of cases judged rightly, with a threshold or, without one, with what fits."""
        used = self.threshold if threshold is None else threshold
        return n_right(self._values(True), self._values(False), used) / len(self.scores)

    def by_seed(self) -> dict[int, FitScore]:
        """Return the same for each seed by itself."""
        seeds = sorted({one.seed for one in self.scores})
        return {seed: FitScore(tuple(one for one in self.scores if one.seed == seed)) for seed in seeds}

    def to_table(self, threshold: float) -> dict[str, Any]:
        """Return plain JSON: margin, threshold, accuracy with it, and the same for each seed."""
        return {
            "margin": round(self.margin, 6),
            "threshold": threshold,
            "accuracy": round(self.accuracy(threshold), 6),
            "by_seed": [
                {
                    "seed": seed,
                    "margin": round(one.margin, 6),
                    "accuracy": round(one.accuracy(threshold), 6),
                    "smallest_container": _named(one.smallest_container),
                    "largest_other": _named(one.largest_other),
                }
                for seed, one in self.by_seed().items()
            ],
        }

    def _values(self, is_container: bool) -> list[float]:
        return [one.score for one in self.scores if one.is_container == is_container]


def best_threshold(containers: Sequence[float], others: Sequence[float]) -> float:
    """Return the threshold that separates containers from other objects best.

    It is the middle between the smallest score of a container and the largest of another object. Where these
    overlap it is the threshold that judges most of them rightly; among equally good ones the one in the
    widest gap between two scores, then the lowest.

    Args:
        containers: their scores, at least one.
        others: of the non-containers, at least one.
    """
    smallest, largest = min(containers), max(others)
    if smallest > largest:
        return _rounded(largest, smallest)
    known = sorted({0.0, *containers, *others})
    gaps = list(zip(known, [*known[1:], 1.0], strict=True))
    best = max(gaps, key=lambda gap: (n_right(containers, others, gap[0]), gap[1] - gap[0], -gap[0]))
    return _rounded(*best)


def n_right(containers: Sequence[float], others: Sequence[float], threshold: float) -> int:
    """Count the scores that a threshold judges rightly: above it is a container."""
    return sum(score > threshold for score in containers) + sum(score <= threshold for score in others)


def _place(one: CaseScore) -> tuple[str, int]:
    return one.name, one.seed


def _named(one: CaseScore) -> list[Any]:
    return [round(one.score, 6), one.name]


def _rounded(low: float, high: float) -> float:
    """The middle, with as few digits as separate the two."""
    middle = (low + high) / 2
    short = round(middle, _DIGITS)
    return short if low <= short < high else middle
