"""Shares with their 95 % intervals, and the interval of an AUC."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from statistics import NormalDist
from typing import TypeAlias

Interval: TypeAlias = tuple[float, float]

_Z = NormalDist().inv_cdf(0.975)
_HALVINGS = 60


@dataclass(frozen=True)
class Share:
    """So many of so many.

    Attributes:
        count: those that are meant.
        n: all of them.
    """

    count: int
    n: int

    @property
    def value(self) -> float | None:
        """From 0 to 1; none of nothing."""
        return self.count / self.n if self.n else None

    @property
    def interval(self) -> Interval | None:
        """95 % score interval of Wilson (1927), which also holds for shares of 0 and 1; none of nothing."""
        share = self.value
        if share is None:
            return None
        weight = _Z**2 / self.n
        middle = (share + weight / 2) / (1 + weight)
        half = _Z / (1 + weight) * sqrt(share * (1 - share) / self.n + weight / (4 * self.n))
        # At the ends rounding alone would keep the bound from being 0 or 1.
        low = 0.0 if self.count == 0 else middle - half
        return low, 1.0 if self.count == self.n else middle + half


def auc_interval(auc: float, n_containers: int, n_others: int) -> Interval:
    """Return the 95 % interval of an AUC, in the manner of Wilson's: it has a width for an AUC of 1, too.

    Method 5 of Newcombe (2006): the variance of Hanley and McNeil, taken at the bound that is sought.
    """
    pairs = n_containers * n_others
    spare = (n_containers + n_others) / 2 - 1

    def deviation(bound: float) -> float:
        shape = (1 - bound) / (2 - bound) + bound / (1 + bound)
        return _Z * sqrt(bound * (1 - bound) * (1 + spare * shape) / pairs)

    low = _edge(lambda bound: auc - bound > deviation(bound), 0.0, auc)
    high = _edge(lambda bound: bound - auc > deviation(bound), 1.0, auc)
    return low, high


def _edge(is_outside: Callable[[float], bool], outside: float, inside: float) -> float:
    """Halve the way between a bound that is too far out and the AUC itself."""
    for _ in range(_HALVINGS):
        middle = (outside + inside) / 2
        if is_outside(middle):
            outside = middle
        else:
            inside = middle
    return inside
