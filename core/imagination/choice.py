"""Which of the imagined pours to make: the paper's rule (Sec. III-B), or the surest of all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry import BoolArray
from core.imagination.cup import cup_pose
from core.imagination.results import PourChoice, PourGrid
from core.imagination.risk.result import PourRisk
from core.parameters.bodies import CupParameters


def choose_pour(
    grid: PourGrid, cup: CupParameters, feasible: BoolArray | None = None, risk: PourRisk | None = None
) -> PourChoice | None:
    """Return the pour with i* = argmax_i sum_j P and j* = argmax_j P(i*, j), or the surest; none if none is
    feasible.

    The surest is, of those that were tried, the one with the largest lower bound of the chance to spill
    nothing, then the one that spills less on average, then the paper's.

    Args:
        grid: the imagined pours.
        cup: whose initial pose is computed (Eq. 6).
        feasible: (I, 3) which pours the arm can make; none: all of them, as in the paper.
        risk: of the same pours; none: the paper's rule.
    """
    ranked = papers_order(grid, feasible)
    if not ranked:
        return None
    i, j = ranked[0]
    if risk is not None:
        i, j = surest_first(risk, ranked)[0]
    theta = float(grid.theta_rad[i])
    pivot = grid.pivot_m[i, j]
    return PourChoice(i, j, theta, pivot, cup_pose(cup, pivot, theta, 0.0))


def papers_order(grid: PourGrid, feasible: BoolArray | None = None) -> list[tuple[int, int]]:
    """Return the feasible pours (i, j), the paper's choice first, with the released code's tie-break.

    Among directions with equal sums, the one with the larger best P wins, then the one whose best indentation
    is smaller, then the one nearer the principal axis, then the first. Within a direction the smallest
    indentation wins. A direction whose best pour the arm cannot make keeps of its sum what its best feasible
    pour has of that best one: the sum stands for how little the distance matters, which no arm changes.

    Args:
        grid: the imagined pours.
        feasible: (I, 3) which pours the arm can make; none: all of them.
    """
    # Counted candies, not ratios: ties must be exact.
    counts = grid.n_in.sum(axis=2)
    allowed = np.ones(counts.shape, dtype=bool) if feasible is None else feasible
    makeable = np.where(allowed, counts, -1)
    best, best_makeable = counts.max(axis=1), makeable.max(axis=1)
    sums = np.where(best_makeable < 0, -1.0, counts.sum(axis=1) * (best_makeable / np.maximum(best, 1)))
    directions = sorted(
        range(len(counts)),
        key=lambda row: (-sums[row], -best_makeable[row], int(makeable[row].argmax()), _from_axis(row), row),
    )
    distances = {row: np.argsort(-makeable[row], kind="stable") for row in directions}
    return [(row, int(j)) for row in directions for j in distances[row] if allowed[row, j]]


def surest_first(risk: PourRisk, order: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return pours (i, j) with the surest first, those that were not tried last; equals keep their order."""
    bound, mean, is_unknown = risk.clean_at_least, risk.mean_spilled, risk.n_tries == 0
    return sorted(order, key=lambda pour: (is_unknown[pour], -bound[pour], mean[pour]))


def _from_axis(i: int) -> int:
    """Steps of pi/4 between direction i and the nearer end of the principal axis."""
    return min(i % 4, 4 - i % 4)
