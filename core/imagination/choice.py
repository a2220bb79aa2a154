"""Which of the imagined pours to make (Sec. III-B), with the released code's tie-break."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray
from core.imagination.cup import cup_pose
from core.imagination.results import PourChoice, PourGrid
from core.parameters.imagination import CupParameters


def choose_pour(grid: PourGrid, cup: CupParameters, feasible: BoolArray | None = None) -> PourChoice | None:
    """Return the pour with i* = argmax_i sum_j P and j* = argmax_j P(i*, j); none if no pour is feasible.

    Among directions with equal sums, the one with the larger best P wins, then the one whose best indentation
    is smaller, then the one nearer the principal axis, then the first. Within a direction the smallest
    indentation wins.

    Args:
        grid: the imagined pours.
        cup: whose initial pose is computed (Eq. 6).
        feasible: (I, 3) which pours the arm can make; none: all of them, as in the paper. A direction whose
            best pour it cannot make keeps of its sum what its best feasible pour has of that best one: the
            sum stands for how little the distance matters, which the arm does not change.
    """
    # Counted candies, not ratios: ties must be exact.
    counts = grid.n_in.sum(axis=2)
    allowed = np.ones(counts.shape, dtype=bool) if feasible is None else feasible
    if not allowed.any():
        return None
    makeable = np.where(allowed, counts, -1)
    best, best_makeable = counts.max(axis=1), makeable.max(axis=1)
    sums = np.where(best_makeable < 0, -1.0, counts.sum(axis=1) * (best_makeable / np.maximum(best, 1)))
    tied = [int(i) for i in np.flatnonzero(sums == sums.max())]
    i = min(tied, key=lambda row: (-best_makeable[row], int(makeable[row].argmax()), _from_axis(row), row))
    j = int(makeable[i].argmax())
    theta = float(grid.theta_rad[i])
    pivot = grid.pivot_m[i, j]
    return PourChoice(i, j, theta, pivot, cup_pose(cup, pivot, theta, 0.0))


def _from_axis(i: int) -> int:
    """Steps of pi/4 between direction i and the nearer end of the principal axis."""
    return min(i % 4, 4 - i % 4)
