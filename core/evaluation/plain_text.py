"""The tables for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill

from core.evaluation.evaluation import Evaluation
from core.evaluation.intervals import Interval, Share
from core.evaluation.statistics import Margin
from core.evaluation.tables import (
    INTERVALS_NOTE,
    MEASURES_NOTE,
    ClassificationRow,
    PouringRow,
    classification_rows,
    figures_of,
    paper_classification,
    paper_pouring,
    pouring_rows,
    truth_sentence,
)
from core.evaluation.trials import Measure, measure_word
from core.evaluation.variants import VARIANTS

WIDTH = 100


def text_tables(evaluation: Evaluation) -> str:
    """Return Tables I and II, the margin of each seed, and what failed, at most `WIDTH` characters wide."""
    judged = [*classification_rows(evaluation), *paper_classification()]
    poured = [*pouring_rows(evaluation), *paper_pouring()]
    parts = [
        "Table I: open container classification, in %",
        text_table(
            ("variant", "objects", "n", "trials", "accuracy", "AUC", "threshold"),
            [_classification_cells(row) for row in judged if row.variant in VARIANTS],
            n_words=2,
        ),
        *(fill(line, WIDTH, subsequent_indent="  ") for line in _measure_lines(evaluation)),
        "",
        "Table II: pours without a spilled candy, in %",
        text_table(
            ("variant", "objects", "n", "pours", "success", "objects w/o any spill"),
            [_pouring_cells(row) for row in poured if row.variant in VARIANTS],
            n_words=2,
        ),
        "",
        *([fill(truth_sentence(evaluation.truth), WIDTH)] if evaluation.truth else []),
        fill(INTERVALS_NOTE, WIDTH),
        fill(MEASURES_NOTE, WIDTH),
        "",
        *_margin_lines(evaluation),
        *_failure_lines(evaluation),
    ]
    return "\n".join(parts).rstrip() + "\n"


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], n_words: int) -> str:
    """Return a table with aligned columns: `n_words` of words to the left, then figures to the right."""
    widths = [max(len(row[k]) for row in (header, *rows)) for k in range(len(header))]
    lines = []
    for row in (header, ["-" * width for width in widths], *rows):
        cells = [
            cell.ljust(width) if k < n_words else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def percent(share: float | None) -> str:
    """Return a share in per cent with two decimals, as the paper gives them."""
    return "–" if share is None else f"{100 * share:.2f}"


def interval_text(interval: Interval | None) -> str:
    """Return an interval in per cent, such as '(87.4–99.6)'; empty if there is none."""
    return "" if interval is None else f"({100 * interval[0]:.1f}–{100 * interval[1]:.1f})"


def bounds_text(interval: Interval) -> str:
    """Return an interval in per cent and in words, such as '87.4 to 99.6'."""
    return f"{100 * interval[0]:.1f} to {100 * interval[1]:.1f}"


def share_text(share: Share) -> str:
    """Return a share in per cent with its interval."""
    return f"{percent(share.value)} {interval_text(share.interval)}".rstrip()


def signed(value: float, decimals: int) -> str:
    """Return a number with its sign, and a true minus."""
    return f"{value:+.{decimals}f}".replace("-", "−")


def margin_sentence(margin: Margin) -> str:
    """Say which container has the smallest score and which non-container the largest."""
    low, high, value = margin.smallest_container, margin.largest_other, margin.value
    parts = [
        f"smallest {measure_word(margin.measure)} of a container {low[0]:.3f} ({low[1]})"
        if low
        else "no container was judged",
        f"largest of a non-container {high[0]:.3f} ({high[1]})" if high else "no non-container was judged",
        f"threshold {margin.threshold:.4g}",
    ]
    if value is not None:
        parts.append(f"margin {signed(value, 3)}")
    return ", ".join(parts)


def _measure_lines(evaluation: Evaluation) -> list[str]:
    """Say which rows are judged by what."""
    by_measure: dict[Measure, list[str]] = {}
    for variant in evaluation.variants:
        by_measure.setdefault(figures_of(evaluation, variant).measure, []).append(variant)
    by_measure.setdefault("Omega", []).append("the paper's")
    return [f"Judged by {measure_word(one)}: {', '.join(names)}." for one, names in by_measure.items()]


def _margin_lines(evaluation: Evaluation) -> list[str]:
    found = figures_of(evaluation, evaluation.variants[0])
    return [
        fill(f"Seed {seed}: {margin_sentence(found.of_seed(seed).margin)}.", WIDTH, subsequent_indent="  ")
        for seed in found.seeds
    ]


def _failure_lines(evaluation: Evaluation) -> list[str]:
    failed = [trial for trial in evaluation.trials if trial.problem]
    said = [f"{one.name} (seed {one.seed}, {one.variant}): {one.problem}" for one in failed]
    lines = [fill(line, WIDTH, initial_indent="  ", subsequent_indent="    ") for line in said]
    return ["", "Failed, and counted as not right or as spilled:", *lines] if lines else []


def _classification_cells(row: ClassificationRow) -> tuple[str, ...]:
    return (
        _name(row),
        row.dataset,
        str(row.n_objects),
        str(row.accuracy.n),
        share_text(row.accuracy),
        f"{percent(row.auc)} {interval_text(row.auc_interval)}".rstrip(),
        "–" if row.threshold is None else f"{row.threshold:.4g}",
    )


def _pouring_cells(row: PouringRow) -> tuple[str, ...]:
    return (
        _name(row),
        row.dataset,
        str(row.n_objects),
        str(row.pours.n),
        share_text(row.pours),
        "" if row.clean_objects is None else share_text(row.clean_objects),
    )


def _name(row: ClassificationRow | PouringRow) -> str:
    """The variant's short name: the titles would not leave room for the figures."""
    return f"{row.variant} (paper)" if row.is_from_paper else row.variant
