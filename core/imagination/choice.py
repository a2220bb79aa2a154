"""Which of the imagined pours to make (Sec. III-B), with the released code's tie-break."""

from __future__ import annotations

import numpy as np

from core.imagination.cup import cup_pose
from core.imagination.results import PourChoice, PourGrid
from core.parameters.imagination import CupParameters


def choose_pour(grid: PourGrid, cup: CupParameters) -> PourChoice:
    """Return the pour with i* = argmax_i sum_j P and j* = argmax_j P(i*, j).

    Among directions with equal sums, the one with the larger best P wins, then the one whose best indentation
    is smaller, then the one nearer the principal axis, then the first. Within a direction the smallest
    indentation wins.
    """
    # Counted candies, not ratios: ties must be exact.
    counts = grid.n_in.sum(axis=2)
    sums = counts.sum(axis=1)
    tied = [int(i) for i in np.flatnonzero(sums == sums.max())]
    i = min(tied, key=lambda row: (-counts[row].max(), int(counts[row].argmax()), _from_axis(row), row))
    j = int(counts[i].argmax())
    theta = float(grid.theta_rad[i])
    pivot = grid.pivot_m[i, j]
    return PourChoice(i, j, theta, pivot, cup_pose(cup, pivot, theta, 0.0))


def _from_axis(i: int) -> int:
    """Steps of pi/4 between direction i and the nearer end of the principal axis."""
    return min(i % 4, 4 - i % 4)
