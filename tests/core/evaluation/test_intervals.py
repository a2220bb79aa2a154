"""Intervals against published values and against the equation they are to solve."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.stats import binomtest

from core.evaluation.intervals import Share, auc_interval


@pytest.mark.parametrize(
    ("count", "n", "low", "high"),
    [  # Newcombe (1998), Table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_as_published(count: int, n: int, low: float, high: float) -> None:
    assert Share(count, n).interval == pytest.approx((low, high), abs=6e-5)


@pytest.mark.parametrize(("count", "n"), [(0, 1), (1, 1), (54, 55), (125, 130), (205, 205), (3, 7)])
def test_wilson_as_scipy_has_it(count: int, n: int) -> None:
    theirs = binomtest(count, n).proportion_ci(method="wilson")
    assert Share(count, n).interval == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_the_papers_shares_and_nothing_of_nothing() -> None:
    assert round(100 * (Share(54, 55).value or 0), 2) == 98.18
    assert round(100 * (Share(125, 130).value or 0), 2) == 96.15
    assert (Share(0, 0).value, Share(0, 0).interval) == (None, None)
    assert Share(7, 7).interval is not None and Share(7, 7).interval[1] == 1.0
    assert Share(0, 7).interval is not None and Share(0, 7).interval[0] == 0.0


@pytest.mark.parametrize(
    ("auc", "n_containers", "n_others"),
    [(0.8932, 51, 58), (1.0, 19, 22), (0.5, 5, 9), (0.0, 4, 4), (0.99, 2, 30)],
)
def test_the_aucs_interval_solves_its_equation(auc: float, n_containers: int, n_others: int) -> None:
    bound = Polynomial([0, 1])
    spare, square = (n_containers + n_others) / 2 - 1, 1.959963984540054**2
    both = (2 - bound) * (1 + bound)
    variance = bound * (1 - bound) * (both + spare * ((1 - bound) * (1 + bound) + bound * (2 - bound)))
    roots = ((bound - auc) ** 2 * both * (n_containers * n_others) - square * variance).roots()
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-7])
    inside = real[(real > -1e-6) & (real < 1 + 1e-6)]
    assert auc_interval(auc, n_containers, n_others) == pytest.approx((inside[0], inside[-1]), abs=1e-6)


def test_a_perfect_auc_of_few_objects_is_not_certain() -> None:
    few, many = auc_interval(1.0, 5, 5), auc_interval(1.0, 50, 50)
    assert few[1] == many[1] == 1.0
    assert few[0] < many[0] < 1.0
