"""The charts of the pages: drawn by matplotlib as SVG, in the page's own colours, with tooltips.

The axes are scaled by the square root: most non-containers are close to 0, where the threshold is decided.
"""

from __future__ import annotations

import html
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.evaluation.labels import Label
from core.evaluation.statistics import Figures
from core.evaluation.trials import Measure, measure_word
from core.geometry import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_TEXT, _SOFT, _LINE, _ACCENT, _OTHER, _CARD = (f"#00000{k}" for k in range(1, 7))
_VARIABLES = dict(
    zip(
        (_TEXT, _SOFT, _LINE, _ACCENT, _OTHER, _CARD),
        ("text", "soft", "line", "accent", "other", "card"),
        strict=True,
    )
)
"""Variables of the page's style sheet, by the colours that stand for them while matplotlib draws."""
_STYLE: Any = {"font.size": 9.5, "text.color": _TEXT, "axes.labelcolor": _TEXT, "svg.fonttype": "none"}
_TICKS = (0.0, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
_N_BINS = 32
_LEAST_BAR = 0.025
"""Height of a bar as a share of the tallest, so that a single trial among hundreds is seen."""
_MARKERS: Mapping[Label, dict[str, Any]] = {
    "container": {"marker": "o", "markerfacecolor": _ACCENT, "markeredgecolor": _ACCENT},
    "non-container": {"marker": "s", "markerfacecolor": "none", "markeredgecolor": _OTHER},
    "ambiguous": {"marker": "^", "markerfacecolor": "none", "markeredgecolor": _SOFT},
}


def histogram(found: Figures) -> str:
    """Draw the score by label: containers upwards, others downwards; those at exactly 0 are text."""
    word = measure_word(found.measure)
    top = _top([*found.scores[0], *found.scores[1], found.threshold])
    edges = top * (np.arange(_N_BINS + 1) / _N_BINS) ** 2
    sides = [np.array(scores, dtype=float) for scores in found.scores]
    counts = [np.histogram(scores[scores > 0], edges)[0] for scores in sides]
    tallest = max(1, *(int(count.max()) for count in counts))
    figure, axes = _figure(7.6, 3.6)
    _square_root(axes, "x", top)
    for kind, sign, colour, its_counts, scores in zip(
        ("container", "non-container"), (1, -1), (_ACCENT, _OTHER), counts, sides, strict=True
    ):
        name = f"{kind.capitalize()}s {'↑' if sign > 0 else '↓'}"
        beside: dict[str, Any] = {"transform": axes.transAxes, "ha": "right"}
        axes.text(-0.03, 0.5 + 0.25 * sign, name, fontweight="bold", **beside)
        axes.text(-0.03, 0.5 + 0.25 * sign - 0.07, f"{np.sum(scores == 0)} at exactly 0", **beside)
        for k in np.flatnonzero(its_counts):
            count, low, high = int(its_counts[k]), edges[k], edges[k + 1]
            height = sign * max(count, _LEAST_BAR * tallest)
            plural = "s" if count > 1 else ""
            (bar,) = axes.bar(low, height, high - low, align="edge", color=colour, edgecolor=_CARD)
            bar.set_gid(f"title: {count} {kind}{plural} with {word} from {low:.3f} to {high:.3f}")
            place = (top * ((k + 0.5) / _N_BINS) ** 2, height)
            above: dict[str, Any] = {"xytext": (0, 3 * sign), "va": "bottom" if sign > 0 else "top"}
            axes.annotate(str(count), place, textcoords="offset points", ha="center", **above)
    axes.set_ylim(-1.15 * tallest, 1.15 * tallest)
    axes.set_yticks([])
    axes.axhline(0, color=_SOFT, linewidth=1)
    axes.set_xlabel(found.measure)
    _threshold(axes, found.threshold)
    return _svg(figure, f"Histogram of {word} by label; threshold {found.threshold:.4g}")


def roc_curve(found: Figures) -> str | None:
    """Draw the ROC curve and the point of the threshold; none without both labels."""
    if not found.roc:
        return None
    figure, axes = _figure(3.6, 3.6)
    axes.set_xlim(0, 100)
    axes.set_ylim(0, 100)
    axes.grid(color=_LINE)
    axes.plot([0, 100], [0, 100], color=_LINE, linestyle="--")
    axes.plot(*(100 * np.array(found.roc).T), color=_ACCENT, linewidth=2, clip_on=False)
    ring: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": _CARD, "markeredgewidth": 2}
    containers, others = _shares_above(found)
    (point,) = axes.plot([100 * others], [100 * containers], color=_TEXT, clip_on=False, zorder=3, **ring)
    point.set_gid(f"title: {roc_sentence(found)}")
    axes.set_xlabel("non-containers judged containers, in %")
    axes.set_ylabel("containers judged containers, in %")
    axes.set_aspect("equal")
    return _svg(figure, f"ROC curve, AUC {100 * (found.auc or 0):.2f} %")


def roc_sentence(found: Figures) -> str:
    """Say what the threshold does; of figures with both labels."""
    containers, others = _shares_above(found)
    return (
        f"at the threshold {found.threshold:.4g}: {100 * containers:.1f} % of the containers "
        f"and {100 * others:.1f} % of the others are judged containers"
    )


def scatter(
    scores: Iterable[tuple[str, Label, float, float]],
    thresholds: tuple[float, float],
    measures: tuple[Measure, Measure],
    alt: str,
) -> str:
    """Draw the score of each object, given as (name, label, before, after), and both thresholds."""
    known = list(scores)
    top = _top([*thresholds, *(score for _, _, *pair in known for score in pair)])
    figure, axes = _figure(5.2, 5.2)
    _square_root(axes, "x", top)
    _square_root(axes, "y", top)
    if measures[0] == measures[1]:
        axes.plot([0, top], [0, top], color=_SOFT, linewidth=1)
    axes.axvline(thresholds[0], color=_TEXT, linestyle="--")
    axes.axhline(thresholds[1], color=_TEXT, linestyle="--")
    for name, label, before, after in known:
        (dot,) = axes.plot([before], [after], linestyle="", clip_on=False, **_MARKERS[label])
        dot.set_gid(f"title: {name} ({label}): {before:.3f} before, {after:.3f} after")
    axes.set_xlabel(f"{measures[0]} before")
    axes.set_ylabel(f"{measures[1]} after")
    axes.set_box_aspect(1)
    return _svg(figure, alt)


def _shares_above(found: Figures) -> tuple[float, float]:
    """Share of the containers and of the others that are judged containers; "cannot tell" is none."""
    cells, (containers, others) = found.confusion, found.scores
    return cells.true_positive / len(containers), cells.false_positive / len(others)


def _figure(width_in: float, height_in: float) -> tuple[Figure, Axes]:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        axes = figure.add_subplot()
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0, labelcolor=_SOFT)
    axes.set_axisbelow(True)
    return figure, axes


def _square_root(axes: Axes, axis: str, top: float) -> None:
    """Give an axis from 0 to `top` the scale of the square root."""

    def root(value: FloatArray) -> FloatArray:
        found: FloatArray = np.sqrt(np.maximum(value, 0))
        return found

    ticks = [tick for tick in _TICKS if tick <= top]
    getattr(axes, f"set_{axis}scale")("function", functions=(root, np.square))
    getattr(axes, f"set_{axis}lim")(0, top)
    getattr(axes, f"set_{axis}ticks")(ticks, [f"{tick:g}" for tick in ticks])
    axes.grid(color=_LINE, axis="both")


def _threshold(axes: Axes, threshold: float) -> None:
    axes.axvline(threshold, color=_TEXT, linestyle="--")
    said = f"threshold {threshold:.4g}"
    place = (threshold, 1.02)
    axes.text(*place, said, transform=axes.get_xaxis_transform(), ha="center", fontweight="bold")


def _top(scores: Sequence[float]) -> float:
    """End of an axis: the first tick from 0.1 on that no score exceeds."""
    largest = max(scores, default=0.0)
    return next((tick for tick in _TICKS[3:] if tick >= largest), 1.0)


def _svg(figure: Figure, alt: str) -> str:
    """Return a figure for a page: its colours are the style sheet's, and the artists' titles are tooltips."""
    from matplotlib import rc_context

    drawn = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with rc_context(_STYLE | {"svg.hashsalt": alt}):  # the same chart is the same text
        figure.savefig(drawn, format="svg", transparent=True, metadata=nothing)
    text = drawn.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(
        r'<svg .*?viewBox="(.*?)".*?>',
        rf'<svg class="chart" role="img" aria-label="{html.escape(alt)}" viewBox="\1">',
        text,
        count=1,
        flags=re.DOTALL,
    )
    text = re.sub(r'<g id="title: (.*?)">', r"<g><title>\1</title>", text)
    for colour, variable in _VARIABLES.items():
        text = text.replace(colour, f"var(--{variable})")
    return text
