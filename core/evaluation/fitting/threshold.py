"""Where the threshold belongs, once the scores of labelled objects are known: their Omegas, say."""

from __future__ import annotations

from collections.abc import Sequence

_DIGITS = 4


def best_threshold(containers: Sequence[float], others: Sequence[float]) -> float:
    """Return the threshold that tells containers from other objects best.

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


def _rounded(low: float, high: float) -> float:
    """The middle, with as few digits as tell the two apart."""
    middle = (low + high) / 2
    short = round(middle, _DIGITS)
    return short if low <= short < high else middle
