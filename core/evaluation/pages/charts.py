"""Where things lie in the charts, in the units of their SVG; `charts.html.j2` draws them.

The axes are to the square root: most non-containers lie close to 0, and there the threshold is decided.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import sqrt

from core.evaluation.labels import Label
from core.evaluation.statistics import Figures
from core.evaluation.trials import Measure, Trial, measure_word

_TICKS = (0.0, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
_N_BINS = 32
_LEAST_BAR = 3.0


@dataclass(frozen=True)
class Tick:
    """A mark on an axis."""

    at: float
    text: str


@dataclass(frozen=True)
class Bar:
    """A bar of the histogram; `count_y` is where its count is written, `title` says it in words."""

    is_container: bool
    x: float
    y: float
    width: float
    height: float
    count: int
    count_y: float
    title: str


@dataclass(frozen=True)
class Histogram:
    """The score by label: containers' bars grow upwards, others' downwards; those at exactly 0 are text."""

    bars: tuple[Bar, ...]
    ticks: tuple[Tick, ...]
    threshold: Tick
    n_zero_containers: int
    n_zero_others: int
    measure: Measure
    WIDTH = 760
    HEIGHT = 360
    LEFT = 150.0
    RIGHT = 740.0
    UP = 166.0
    DOWN = 194.0
    TALLEST = 122.0


@dataclass(frozen=True)
class RocCurve:
    """The ROC curve and the point of the threshold."""

    points: str
    at: tuple[float, float]
    said: str
    SIZE = 360
    LEFT = 58.0
    TOP = 18.0
    SIDE = 280.0
    TICKS = (0, 20, 40, 60, 80, 100)


@dataclass(frozen=True)
class Dot:
    """An object in the scatter plot."""

    x: float
    y: float
    label: Label
    title: str


@dataclass(frozen=True)
class Scatter:
    """The score of each object before (to the right) and after (upwards), and both thresholds."""

    dots: tuple[Dot, ...]
    ticks: tuple[Tick, ...]
    thresholds: tuple[Tick, Tick]
    measures: tuple[Measure, Measure]
    SIZE = 520
    LEFT = 62.0
    TOP = 18.0
    SIDE = 440.0


def place(score: float, top: float = 1.0) -> float:
    """Return where a score lies on an axis from 0 to `top`: 0 to 1, to the square root."""
    return min(1.0, sqrt(score / top))


def histogram(found: Figures) -> Histogram:
    """Lay out the histogram of the score by label."""
    judged = [(trial.score, trial) for trial in found.trials if trial.score is not None]
    threshold = found.margin.threshold
    top = _top([*(score for score, _ in judged), threshold])
    sides = {
        is_container: [score for score, one in judged if (one.label == "container") == is_container]
        for is_container in (True, False)
    }
    counts = {side: _counts(scores, top) for side, scores in sides.items()}
    most = max((count for side in counts.values() for count in side), default=1) or 1
    span = Histogram.RIGHT - Histogram.LEFT
    return Histogram(
        tuple(
            _bar(side, k, count, (most, top), measure_word(found.measure))
            for side, found_counts in counts.items()
            for k, count in enumerate(found_counts)
            if count
        ),
        _ticks(top, Histogram.LEFT, span),
        Tick(Histogram.LEFT + span * place(threshold, top), f"threshold {threshold:.4g}"),
        sides[True].count(0.0),
        sides[False].count(0.0),
        found.measure,
    )


def roc_curve(found: Figures) -> RocCurve | None:
    """Lay out the ROC curve; none without both labels."""
    if not found.roc:
        return None
    cells = found.confusion
    share_others = cells.false_positive / (cells.false_positive + cells.true_negative)
    share_containers = cells.true_positive / (cells.true_positive + cells.false_negative)
    return RocCurve(
        " ".join("{:.1f},{:.1f}".format(*_in_roc(*point)) for point in found.roc),
        _in_roc(share_others, share_containers),
        f"at the threshold {found.margin.threshold:.4g}: {100 * share_containers:.1f} % of the containers "
        f"and {100 * share_others:.1f} % of the others are judged containers",
    )


def scatter(
    scores: Iterable[tuple[str, Label, float, float]],
    thresholds: tuple[float, float],
    measures: tuple[Measure, Measure],
) -> Scatter:
    """Lay out the scatter plot of (name, label, score before, score after)."""
    known = list(scores)
    top = _top([*thresholds, *(score for _, _, *pair in known for score in pair)])
    bottom = Scatter.TOP + Scatter.SIDE
    before, after = thresholds
    return Scatter(
        tuple(
            Dot(
                Scatter.LEFT + Scatter.SIDE * place(x, top),
                bottom - Scatter.SIDE * place(y, top),
                label,
                f"{name} ({label}): {x:.3f} before, {y:.3f} after",
            )
            for name, label, x, y in known
        ),
        _ticks(top, 0.0, Scatter.SIDE),
        (
            Tick(Scatter.LEFT + Scatter.SIDE * place(before, top), f"threshold {before:.4g}"),
            Tick(bottom - Scatter.SIDE * place(after, top), f"threshold {after:.4g}"),
        ),
        measures,
    )


def seed_marks(trials: Iterable[Trial]) -> list[float]:
    """Return where each trial's score lies on a card's scale from 0 to 1, in per cent."""
    return [round(100 * place(trial.score), 1) for trial in trials if trial.score is not None]


def _bar(is_container: bool, k: int, count: int, scale: tuple[int, float], word: str) -> Bar:
    """Bar k of so many; the scale is (the most in a bar, the end of the axis)."""
    most, top = scale
    width = (Histogram.RIGHT - Histogram.LEFT) / _N_BINS
    height = max(_LEAST_BAR, Histogram.TALLEST * count / most)
    low, high = (top * (edge / _N_BINS) ** 2 for edge in (k, k + 1))
    y = Histogram.UP - height if is_container else Histogram.DOWN
    return Bar(
        is_container,
        Histogram.LEFT + k * width + 1,
        y,
        width - 2,
        height,
        count,
        y - 5 if is_container else y + height + 14,
        f"{count} {'container' if is_container else 'non-container'}{'s' if count > 1 else ''} with {word} "
        f"from {low:.3f} to {high:.3f}",
    )


def _counts(scores: Sequence[float], top: float) -> list[int]:
    counts = [0] * _N_BINS
    for score in scores:
        if score > 0:
            counts[min(_N_BINS - 1, int(_N_BINS * place(score, top)))] += 1
    return counts


def _top(scores: Sequence[float]) -> float:
    largest = max(scores, default=0.0)
    return next((tick for tick in _TICKS[3:] if tick >= largest), 1.0)


def _ticks(top: float, start: float, span: float) -> tuple[Tick, ...]:
    return tuple(Tick(start + span * place(tick, top), f"{tick:g}") for tick in _TICKS if tick <= top)


def _in_roc(share_others: float, share_containers: float) -> tuple[float, float]:
    return (
        RocCurve.LEFT + RocCurve.SIDE * share_others,
        RocCurve.TOP + RocCurve.SIDE * (1 - share_containers),
    )
