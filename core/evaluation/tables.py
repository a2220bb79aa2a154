"""Tables I and II of the paper, as rows and as text for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Any

from core.evaluation.best_view import ViewAccuracies, view_accuracies
from core.evaluation.evaluation import Evaluation
from core.evaluation.statistics import (
    NEAR,
    CapacityFigures,
    Figures,
    Interval,
    Share,
    auc_interval,
    capacity_figures,
    figures_of,
    sets_of,
)
from core.evaluation.trials import Measure, measure_word
from core.evaluation.variants import VARIANTS

WIDTH = 100
"""Of the text, in characters."""
INTERVALS_NOTE = (
    "In brackets 95 % intervals (Wilson; of the AUC: Newcombe). They take trials and pours as independent; "
    "those of one object are not, so with several seeds or pours the true intervals are wider."
)
DECLINED_NOTE = (
    "Declined: the program advised not to pour. That is right where fewer pours were clean than wanted, and "
    "such an object counts nowhere else; where it is wrong, all of the object's pours count as spilled."
)
MEASURES_NOTE = (
    "Capacity share: the volume that an imagined filling leaves in the object, as a share of its convex "
    "hull's. Omega: the share of the candies dropped on it that stay."
)
_PAPER = (
    # variant, method, objects, containers, others, judged right, poured without a spill, Omega_thr
    ("appearance", "AffordanceNet", "restricted", 23, 28, 51, 19, None),
    ("appearance-3d", "AffordanceNet w/ 3D Scanning", "restricted", 23, 28, None, 21, None),
    ("fixed-theta", "Imagination w/ fixed theta", "restricted", 23, 28, None, 23, None),
    ("imagination", "Imagination", "restricted", 23, 28, 51, 23, 0.0),
    ("fixed-theta", "Imagination w/ fixed theta", "full", 55, 75, None, 52, None),
    ("imagination", "Imagination", "full", 55, 75, 125, 54, 0.0),
)


@dataclass(frozen=True)
class TableRow:
    """A method's row of a set of objects in both tables.

    Attributes:
        variant: its short name.
        method: in the paper's words.
        dataset: name of the set of objects.
        n_objects: labelled objects.
        n_containers: labelled containers that pours were meant for.
        accuracy: trials judged right; none where Table I has no such row.
        right_objects: objects judged right with every seed; none where that is not known.
        auc: from 0 to 1; none if there is only one label.
        auc_interval: 95 %.
        measure: what judges; none where it is neither.
        threshold: of the measure; none where there is no measure.
        pours: pours without a spilled candy; of nothing where Table II has no such row.
        declined: of the trials in which pouring into a container was not advised, those in which that was
            right; none where nothing is advised.
        clean_objects: containers of which no pour spilled a candy; none where that is not known.
        is_from_paper: whether it is the paper's own, on its own objects.
    """

    variant: str
    method: str
    dataset: str
    n_objects: int
    n_containers: int
    accuracy: Share | None
    right_objects: Share | None
    auc: float | None
    auc_interval: Interval | None
    measure: Measure | None
    threshold: float | None
    pours: Share
    declined: Share | None
    clean_objects: Share | None
    is_from_paper: bool = False

    @property
    def rule(self) -> str:
        """What makes a container, such as 'Omega > 0.13'; empty where it is neither measure."""
        if self.measure is None or self.threshold is None:
            return ""
        return f"{measure_word(self.measure)} > {self.threshold:.4g}"

    @property
    def short_name(self) -> str:
        """The variant's name for a terminal: the titles would leave no space for the figures."""
        return f"{self.variant} (paper)" if self.is_from_paper else self.variant


def title_of(variant: str) -> str:
    """Return a variant's title; one that this version does not know keeps its name."""
    return VARIANTS[variant].title if variant in VARIANTS else variant


def table_rows(evaluation: Evaluation) -> list[TableRow]:
    """Return the rows of both tables, set by set, in each all variants."""
    return [
        _row(variant, name, figures_of(evaluation, variant, members))
        for name, members in sets_of(evaluation.objects).items()
        for variant in evaluation.variants
    ]


def paper_rows() -> list[TableRow]:
    """Return the paper's own rows, with the intervals that its numbers of objects give."""
    return [
        TableRow(
            variant,
            method,
            dataset,
            n_containers + n_others,
            n_containers,
            None if n_right is None else Share(n_right, n_containers + n_others),
            None,
            1.0,
            auc_interval(1.0, n_containers, n_others),
            None if threshold is None else "Omega",
            threshold,
            Share(n_clean, n_containers),
            None,
            None,
            is_from_paper=True,
        )
        for variant, method, dataset, n_containers, n_others, n_right, n_clean, threshold in _PAPER
    ]


def classification(rows: Sequence[TableRow]) -> list[TableRow]:
    """Return the rows of Table I."""
    return [row for row in rows if row.accuracy is not None]


def pouring(rows: Sequence[TableRow]) -> list[TableRow]:
    """Return the rows of Table II; a set without containers has none."""
    return [row for row in rows if row.pours.n]


def text_tables(evaluation: Evaluation) -> str:
    """Return Tables I and II, the margin of each seed, and what failed, at most `WIDTH` characters wide."""
    rows = [row for row in [*table_rows(evaluation), *paper_rows()] if row.variant in VARIANTS]
    parts = [
        "Table I: open container classification, in %",
        text_table(
            ("variant", "objects", "n", "trials", "accuracy", "AUC", "threshold"),
            [_classification_cells(row, row.accuracy) for row in rows if row.accuracy is not None],
            n_words=2,
        ),
        *(fill(line, WIDTH, subsequent_indent="  ") for line in _measure_lines(evaluation)),
        *_undecided_lines(evaluation),
        *_capacity_lines(evaluation),
        *_view_lines(evaluation),
        "",
        "Table II: pours without a spilled candy, in %",
        text_table(
            ("variant", "objects", "n", "pours", "success", "declined", "clean objects"),
            [_pouring_cells(row) for row in pouring(rows)],
            n_words=2,
        ),
        "",
        *_world_lines(evaluation),
        *([fill(truth_sentence(evaluation.truth), WIDTH)] if evaluation.truth else []),
        fill(INTERVALS_NOTE, WIDTH),
        fill(MEASURES_NOTE, WIDTH),
        fill(DECLINED_NOTE, WIDTH),
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


def with_interval(share: float | None, interval: Interval | None) -> str:
    """Return a share in per cent with its interval."""
    return f"{percent(share)} {interval_text(interval)}".rstrip()


def signed(value: float, decimals: int) -> str:
    """Return a number with its sign, and a true minus."""
    return f"{value:+.{decimals}f}".replace("-", "−")


def margin_sentence(found: Figures) -> str:
    """Say which container has the smallest score and which non-container the largest."""
    margin, measure = found.margin, measure_word(found.measure)
    low, high = margin.smallest_container, margin.largest_other
    parts = [
        f"smallest {measure} of a container {low[0]:.3f} ({low[1]})" if low else "no container was judged",
        f"largest of a non-container {high[0]:.3f} ({high[1]})" if high else "no non-container was judged",
        f"threshold {found.threshold:.4g}",
    ]
    if margin.value is not None:
        parts.append(f"margin {signed(margin.value, 3)}")
    return ", ".join(parts)


def truth_sentence(truth: Mapping[str, Any]) -> str:
    """Say which settings of the ground-truth simulation (SI units) are not the usual ones."""
    chosen = ", ".join(
        f"{name} = {value:.4g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in truth.items()
    )
    return f"The ground-truth worlds did not have their usual settings: {chosen}."


def _row(variant: str, dataset: str, found: Figures) -> TableRow:
    return TableRow(
        variant,
        title_of(variant),
        dataset,
        len(found.names),
        found.clean_objects.n,
        found.accuracy,
        found.right_objects,
        found.auc,
        found.auc_interval,
        found.measure,
        found.threshold,
        found.pours,
        found.declined,
        found.clean_objects,
    )


def _classification_cells(row: TableRow, accuracy: Share) -> tuple[str, ...]:
    return (
        row.short_name,
        row.dataset,
        str(row.n_objects),
        str(accuracy.n),
        with_interval(accuracy.value, accuracy.interval),
        with_interval(row.auc, row.auc_interval),
        "–" if row.threshold is None else f"{row.threshold:.4g}",
    )


def _pouring_cells(row: TableRow) -> tuple[str, ...]:
    pours, clean = row.pours, row.clean_objects
    return (
        row.short_name,
        row.dataset,
        str(row.n_containers),
        str(pours.n),
        with_interval(pours.value, pours.interval),
        declined_text(row.declined),
        "" if clean is None else with_interval(clean.value, clean.interval),
    )


def declined_text(declined: Share | None) -> str:
    """Return how often pouring was not advised, and how often rightly, such as '2 (1 right)'."""
    if declined is None:
        return ""
    return f"{declined.n} ({declined.count} right)" if declined.n else "0"


def world_rows(evaluation: Evaluation) -> list[tuple[str, str, Share]]:
    """Return (method, ground-truth world, pours without a spilled candy) where there are several worlds."""
    if len(evaluation.worlds) < 2:
        return []
    rows = [
        (title_of(variant), world, figures_of(evaluation, variant).pours_in(world))
        for variant in evaluation.variants
        for world in evaluation.worlds
    ]
    return [row for row in rows if row[2].n]


def _world_lines(evaluation: Evaluation) -> list[str]:
    rows = [
        (method, world, str(pours.n), with_interval(pours.value, pours.interval))
        for method, world, pours in world_rows(evaluation)
    ]
    if not rows:
        return []
    return [
        "The same pours by ground-truth world, in %",
        text_table(("variant", "world", "pours", "success"), rows, n_words=2),
        "",
    ]


def _measure_lines(evaluation: Evaluation) -> list[str]:
    """Say which rows are judged by what."""
    by_measure: dict[Measure, list[str]] = {}
    for variant in evaluation.variants:
        by_measure.setdefault(figures_of(evaluation, variant).measure, []).append(variant)
    by_measure.setdefault("Omega", []).append("the paper's")
    return [f"Judged by {measure_word(one)}: {', '.join(names)}." for one, names in by_measure.items()]


def _undecided_lines(evaluation: Evaluation) -> list[str]:
    """Name the objects of which it cannot be told, where there are any; ambiguous ones count nowhere."""
    lines = []
    for variant in evaluation.variants:
        undecided = [one for one in evaluation.of_variant(variant) if one.is_undecided]
        for is_counted, how in ((True, "counted as not right"), (False, "ambiguous, not counted")):
            names = [one.name for one in undecided if (one.label != "ambiguous") == is_counted]
            if names:
                said = f"Cannot tell ({variant}), {how}: {', '.join(names)}."
                lines.append(fill(said, WIDTH, subsequent_indent="  "))
    return lines


def _capacity_lines(evaluation: Evaluation) -> list[str]:
    """Say how true the capacities are, where the true ones are known."""
    lines = []
    for variant in evaluation.variants:
        found = capacity_figures(evaluation, variant)
        if found is not None:
            lines.append(fill(f"{variant}: {capacity_sentence(found)}", WIDTH, subsequent_indent="  "))
    return lines


def capacity_sentence(found: CapacityFigures) -> str:
    """Say how many capacities are near the true ones, and how often these lie within the stated bounds."""
    near, within = found.near, found.within
    said = f"capacity within {100 * NEAR:.0f} % of the true one: {near.count} of {near.n}"
    if not within.n:
        return f"{said}."
    return f"{said}; the true one lies within the stated bounds: {within.count} of {within.n}."


def _view_lines(evaluation: Evaluation) -> list[str]:
    """Say from which view the rows by looks are judged, and what the others would have been worth."""
    lines = []
    for variant in evaluation.variants:
        found = view_accuracies(evaluation.of_variant(variant))
        if found is not None:
            lines.append(fill(f"{variant}: {best_view_sentence(found)}", WIDTH, subsequent_indent="  "))
    return lines


def best_view_sentence(found: ViewAccuracies) -> str:
    """Say which view counts, and why that flatters."""
    mean, top_down = percent(found.mean), percent(found.top_down)
    return (
        f"judged from the best of {len(found.by_view)} views, {found.best}, chosen on these very objects as "
        f"in Sec. V-A ({percent(found.by_view[found.best])} %). The mean over the views is {mean} %; from "
        f"each object's most steeply downward view, which needs no choice, {top_down} % are right."
    )


def _margin_lines(evaluation: Evaluation) -> list[str]:
    found = figures_of(evaluation, evaluation.variants[0])
    return [
        fill(f"Seed {seed}: {margin_sentence(found.of_seed(seed))}.", WIDTH, subsequent_indent="  ")
        for seed in found.seeds
    ]


def _failure_lines(evaluation: Evaluation) -> list[str]:
    lines = [
        fill(
            f"{one.name} (seed {one.seed}, {one.variant}): {one.problem}",
            WIDTH,
            initial_indent="  ",
            subsequent_indent="    ",
        )
        for one in evaluation.trials
        if one.problem
    ]
    return ["", "Failed, and counted as not right or as spilled:", *lines] if lines else []
