"""What was found of each pour's risk: how often it was tried, and what each try spilled."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_json, write_json
from core.geometry import FloatArray, IntArray
from core.imagination.results import PourGrid

RISK_FILE = "risk.json"
NOT_TRIED = -1
_DOUBT = 0.05
"""Chance that the true share of clean pours is below the bound."""


@dataclass(frozen=True)
class PourRisk:
    """Tries of each pour: first those of the pouring imagination, without errors, then those with errors.

    Attributes:
        n_pour: N_pour.
        spilled: (I, 3, T) candies that fell beside the object, `NOT_TRIED` where there was no such try.
    """

    n_pour: int
    spilled: IntArray

    @classmethod
    def as_planned(cls, grid: PourGrid) -> PourRisk:
        """Return what is known before any try with errors."""
        return cls(grid.n_pour, grid.n_spilled)

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
        """(I, 3) spilled candies a try."""
        mean: FloatArray = np.where(self.spilled == NOT_TRIED, 0, self.spilled).sum(axis=2) / self.n_tries
        return mean

    @property
    def expected_clean(self) -> FloatArray:
        """(I, 3) chance that the next try spills nothing, by Laplace's rule of succession."""
        expected: FloatArray = (self.n_clean + 1) / (self.n_tries + 2)
        return expected

    @property
    def clean_at_least(self) -> FloatArray:
        """(I, 3) chance of spilling nothing: the lower 95 % bound, all chances being as likely beforehand."""
        from scipy.special import betaincinv

        bound: FloatArray = np.asarray(
            betaincinv(self.n_clean + 1, self.n_tries - self.n_clean + 1, _DOUBT), dtype=np.float64
        )
        return bound

    def to_table(self) -> dict[str, Any]:
        """Return the table of the command-line contract."""
        return {
            "n_pour": self.n_pour,
            "n_tries": self.n_tries.tolist(),
            "n_clean": self.n_clean.tolist(),
            "clean_at_least": self.clean_at_least.tolist(),
            "mean_spilled": self.mean_spilled.tolist(),
            "spilled": [[[int(n) for n in pour if n != NOT_TRIED] for pour in row] for row in self.spilled],
        }

    def save(self, folder: Path) -> None:
        """Write `risk.json`."""
        write_json(folder / RISK_FILE, self.to_table())

    @classmethod
    def load(cls, folder: Path) -> PourRisk:
        """Read what `save` wrote."""
        table = read_json(folder / RISK_FILE)
        return cls(table["n_pour"], joined(table["spilled"]))


def joined(tries: list[list[list[int]]]) -> IntArray:
    """Return (I, 3, T) from the tries of each pour, of which some have more than others."""
    longest = max(len(pour) for row in tries for pour in row)
    spilled = np.full((len(tries), len(tries[0]), longest), NOT_TRIED, dtype=np.int64)
    for i, row in enumerate(tries):
        for j, pour in enumerate(row):
            spilled[i, j, : len(pour)] = pour
    return spilled
