"""What the tries of the pours say: frozen, and able to save and load itself."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cache
from math import lgamma, log, log1p
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_json, write_json
from core.geometry import AnyArray, FloatArray, IntArray
from core.imagination.results import PourGrid

RISK_FILE = "risk.json"
NOT_TRIED = -1
_DOUBT = 0.05
"""Chance that the true share of clean pours is below the bound."""


def lower_bound(n_clean: AnyArray, n_tries: AnyArray) -> FloatArray:
    """Return the lower 95 % bound of a share of clean pours, all shares being as likely beforehand."""
    bound: FloatArray = np.vectorize(_lower_bound, otypes=[np.float64])(n_clean, n_tries)
    return bound


@cache
def _lower_bound(n_clean: int, n_tries: int) -> float:
    """The 5 % quantile of Beta(n_clean + 1, n_tries - n_clean + 1).

    By halving: of so few tries that distribution is a sum of binomial chances. SciPy has the function, and
    costs the window, which shows these bounds, 27 MB.
    """
    n = n_tries + 1
    k = np.arange(n_clean + 1, n + 1)
    log_ways = np.array([lgamma(n + 1) - lgamma(i + 1) - lgamma(n - i + 1) for i in k])
    low, high = 0.0, 1.0
    while low < (middle := (low + high) / 2) < high:
        chances = np.exp(log_ways + k * log(middle) + (n - k) * log1p(-middle))
        low, high = (middle, high) if chances.sum() < _DOUBT else (low, middle)
    return low


@dataclass(frozen=True)
class FewerCandies:
    """A smaller amount that one of the pours makes surely enough.

    Attributes:
        n_candies: in one cup.
        i: index of the pour's direction.
        j: index of its distance.
        n_tries: with errors of the set-up.
        n_clean: of these.
    """

    n_candies: int
    i: int
    j: int
    n_tries: int
    n_clean: int

    @property
    def clean_at_least(self) -> float:
        """Chance of spilling nothing, as its lower 95 % bound."""
        return float(lower_bound(np.array(self.n_clean), np.array(self.n_tries)))


@dataclass(frozen=True)
class PourRisk:
    """Tries of each pour: first those of the pouring imagination, without errors, then those with errors.

    Attributes:
        n_pour: N_pour.
        spilled: (I, 3, T) candies that fell beside the object, `NOT_TRIED` where there was no such try.
        n_cups: poured one after the other in each try with errors, onto the candies of those before.
        fewer: candies that would be sure enough, where no pour of N_pour is; none: not needed, or not found.
    """

    n_pour: int
    spilled: IntArray
    n_cups: int = 1
    fewer: FewerCandies | None = None

    @classmethod
    def as_planned(cls, grid: PourGrid) -> PourRisk:
        """Return what is known before any try with errors.

        A first cup that spills has spilled of the whole amount; a clean one says nothing of the others.
        """
        is_whole = (grid.n_cups == 1) | (grid.n_spilled > 0)
        return cls(grid.n_pour, np.where(is_whole, grid.n_spilled, NOT_TRIED), grid.n_cups)

    @classmethod
    def untried(cls, grid: PourGrid) -> PourRisk:
        """Return that nothing is known."""
        return cls(grid.n_pour, np.full((*grid.n_in.shape[:2], 1), NOT_TRIED), grid.n_cups)

    @property
    def n_tries(self) -> IntArray:
        """(I, 3) how often each pour was tried."""
        tries: IntArray = (self.spilled != NOT_TRIED).sum(axis=2)
        return tries

    @property
    def n_clean(self) -> IntArray:
        """(I, 3) tries in which nothing was spilled."""
        clean: IntArray = (self.spilled == 0).sum(axis=2)
        return clean

    @property
    def mean_spilled(self) -> FloatArray:
        """(I, 3) spilled candies a try; zero of a pour that was not tried."""
        total = np.where(self.spilled == NOT_TRIED, 0, self.spilled).sum(axis=2)
        mean: FloatArray = total / np.maximum(self.n_tries, 1)
        return mean

    @property
    def expected_clean(self) -> FloatArray:
        """(I, 3) chance that the next try spills nothing, by Laplace's rule of succession."""
        expected: FloatArray = (self.n_clean + 1) / (self.n_tries + 2)
        return expected

    @property
    def clean_at_least(self) -> FloatArray:
        """(I, 3) chance of spilling nothing: the lower 95 % bound, all chances being as likely beforehand."""
        return lower_bound(self.n_clean, self.n_tries)

    def to_table(self) -> dict[str, Any]:
        """Return the table of the command-line contract."""
        return {
            "n_pour": self.n_pour,
            "n_cups": self.n_cups,
            "n_tries": self.n_tries.tolist(),
            "n_clean": self.n_clean.tolist(),
            "clean_at_least": self.clean_at_least.tolist(),
            "mean_spilled": self.mean_spilled.tolist(),
            "spilled": [[[int(n) for n in pour if n != NOT_TRIED] for pour in row] for row in self.spilled],
            "fewer": None if self.fewer is None else asdict(self.fewer),
        }

    def save(self, folder: Path) -> None:
        """Write `risk.json`."""
        write_json(folder / RISK_FILE, self.to_table())

    @classmethod
    def load(cls, folder: Path) -> PourRisk:
        """Read what `save` wrote."""
        table = read_json(folder / RISK_FILE)
        fewer = table.get("fewer")
        return cls(
            table["n_pour"],
            joined(table["spilled"]),
            table.get("n_cups", 1),
            None if fewer is None else FewerCandies(**fewer),
        )


def joined(tries: list[list[list[int]]]) -> IntArray:
    """Return (I, 3, T) from the tries of each pour, of which some have more than others."""
    longest = max(len(pour) for row in tries for pour in row)
    spilled = np.full((len(tries), len(tries[0]), longest), NOT_TRIED, dtype=np.int64)
    for i, row in enumerate(tries):
        for j, pour in enumerate(row):
            spilled[i, j, : len(pour)] = pour
    return spilled
