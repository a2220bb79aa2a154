"""A comparison of two evaluations: as text for the terminal, and as one HTML file that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import fill
from typing import Any

from core.evaluation.comparing import Change, Comparison, ObjectPair, VariantPair, compare
from core.evaluation.evaluation import Evaluation
from core.evaluation.pages.charts import scatter
from core.evaluation.pages.report import render, title_text
from core.evaluation.statistics import Share
from core.evaluation.tables import (
    INTERVALS_NOTE,
    MEASURES_NOTE,
    WIDTH,
    margin_sentence,
    signed,
    text_table,
    title_of,
    with_interval,
)
from core.evaluation.trials import Measure, measure_word
from core.files import write_whole
from core.session.explaining import explained

_TITLES: dict[Change, str] = {
    "judged worse": "Judged right less often than before",
    "spilled more": "Spilled more often than before",
    "judged better": "Judged right more often than before",
    "spilled less": "Spilled less often than before",
}


@dataclass(frozen=True)
class FigureRow:
    """A figure before and after, and by how much it has grown."""

    name: str
    before: str
    after: str
    difference: str


def write_comparison(before: Evaluation, after: Evaluation, path: Path) -> str:
    """Write the comparison of two evaluations as one HTML file.

    Args:
        before: the earlier one.
        after: the later one.
        path: of the HTML file.

    Returns:
        The same as text for a terminal, at most `WIDTH` characters wide.

    Raises:
        InputError: they have no object in common.
        SessionError: the disk is full or the folder may not be written.
    """
    found = compare(before, after)
    page = {
        "found": found,
        "before": title_text(before),
        "after": title_text(after),
        "variants": [_variant_data(pair) for pair in found.variants],
        "intervals_note": INTERVALS_NOTE,
        "measures_note": MEASURES_NOTE,
    }
    with explained(path.parent):
        write_whole(path, render("comparison.html.j2", page))
    return _text(found)


def figure_rows(pair: VariantPair) -> list[FigureRow]:
    """Return the figures of a variant, with their intervals."""
    before, after = pair.figures
    aucs = [with_interval(found.auc, found.auc_interval) for found in pair.figures]
    margins = before.margin.value, after.margin.value
    return [
        _share_row("accuracy, %", before.accuracy, after.accuracy),
        _share_row("objects right with every seed, %", before.right_objects, after.right_objects),
        FigureRow("AUC, %", aucs[0], aucs[1], _difference(before.auc, after.auc, 2, 100)),
        _share_row("pours without a spilled candy, %", before.pours, after.pours),
        _share_row("containers without any spill, %", before.clean_objects, after.clean_objects),
        _score_row(f"margin of {_measures_text(pair.measures)}", *margins, pair.measures),
        _score_row("threshold", before.threshold, after.threshold, pair.measures),
        _number_row("seconds of work a trial", *pair.seconds, 2),
    ]


def change_sentence(pair: VariantPair, one: ObjectPair, change: Change) -> str:
    """Say how an object changed, such as 'mug: right 5 of 5, now 3 of 5; Omega 0.310, now 0.020'."""
    is_judged = change in ("judged worse", "judged better")
    before, after = one.right if is_judged else one.clean
    word = "right" if is_judged else "clean"
    old, new = ("unknown" if score is None else f"{score:.3f}" for score in one.score)
    measures = [measure_word(measure) for measure in pair.measures]
    is_same = measures[0] == measures[1]
    return (
        f"{one.name}: {word} {before.count} of {before.n}, now {after.count} of {after.n}; "
        f"{measures[0]} {old}, now {new if is_same else f'{measures[1]} {new}'}"
    )


def _changes(pair: VariantPair) -> list[tuple[str, list[str]]]:
    """Titles, each with a sentence for each object that changed so."""
    return [
        (title, [change_sentence(pair, one, change) for one in pair.changed(change)])
        for change, title in _TITLES.items()
        if pair.changed(change)
    ]


def _margins(pair: VariantPair) -> list[str]:
    before, after = pair.figures
    return [f"Before: {margin_sentence(before)}.", f"After: {margin_sentence(after)}."]


def _measures_text(measures: tuple[Measure, Measure]) -> str:
    """Say what judged before and after, such as 'Omega' or 'Omega, now of capacity share'."""
    before, after = (measure_word(measure) for measure in measures)
    return before if before == after else f"{before}, now of {after}"


def _text(found: Comparison) -> str:
    changes = [f"{what}: {old}, now {new}" for what, old, new in found.settings]
    changes += [f"{name}: {old}, now {new}" for name, old, new, _ in found.parameters]
    notes = {
        "Only before": found.only_before,
        "Only after": found.only_after,
        "Labelled differently": [f"{name} ({old}, now {new})" for name, old, new in found.relabelled],
        "Different mesh": found.other_meshes,
    }
    parts = [
        _lines("What was changed:", changes) if changes else "Settings and parameters are the same.",
        *(_variant_text(pair) for pair in found.variants),
        *(_wrapped(f"{title}: {', '.join(names)}") for title, names in notes.items() if names),
    ]
    return "\n\n".join(parts) + "\n"


def _variant_text(pair: VariantPair) -> str:
    title = pair.after if pair.before == pair.after else f"{pair.before} before, {pair.after} after"
    rows = [(row.name, row.before, row.after, row.difference) for row in figure_rows(pair)]
    table = text_table((title, "before", "after", "difference"), rows, n_words=1)
    changes = [_lines(f"{title}:", sentences) for title, sentences in _changes(pair)]
    margins = "\n".join(_wrapped(sentence) for sentence in _margins(pair))
    return "\n\n".join([table, margins, *(changes or ["No object flipped."])])


def _variant_data(pair: VariantPair) -> dict[str, Any]:
    titles = title_of(pair.before), title_of(pair.after)
    scores = ((one, *one.score) for one in pair.objects)
    known = [
        (one.name, one.label, old, new) for one, old, new in scores if old is not None and new is not None
    ]
    measures = _measures_text(pair.measures)
    thresholds = pair.figures[0].threshold, pair.figures[1].threshold
    return {
        "title": titles[1] if titles[0] == titles[1] else f"{titles[0]} before, {titles[1]} after",
        "n_objects": len(pair.objects),
        "rows": figure_rows(pair),
        "margins": _margins(pair),
        "changes": _changes(pair),
        "scatter": scatter(known, thresholds, pair.measures, f"Each object before and after: {measures}"),
        "is_same_measure": pair.measures[0] == pair.measures[1],
    }


def _lines(title: str, sentences: Iterable[str]) -> str:
    return "\n".join([title, *(_wrapped(f"  {sentence}") for sentence in sentences)])


def _wrapped(text: str) -> str:
    return fill(text, WIDTH, subsequent_indent="    ")


def _share_row(name: str, before: Share, after: Share) -> FigureRow:
    old, new = (with_interval(share.value, share.interval) for share in (before, after))
    return FigureRow(name, old, new, _difference(before.value, after.value, 2, 100))


def _number_row(name: str, before: float | None, after: float | None, decimals: int) -> FigureRow:
    old, new = ("–" if one is None else f"{one:.{decimals}f}".replace("-", "−") for one in (before, after))
    return FigureRow(name, old, new, _difference(before, after, decimals))


def _score_row(
    name: str, before: float | None, after: float | None, measures: tuple[Measure, Measure]
) -> FigureRow:
    """Of a score or its threshold: between two measures there is no difference."""
    row = _number_row(name, before, after, 3)
    return row if measures[0] == measures[1] else replace(row, difference="")


def _difference(before: float | None, after: float | None, decimals: int, scale: float = 1) -> str:
    if before is None or after is None:
        return ""
    value = round(scale * (after - before), decimals)
    return signed(value, decimals) if value else "same"
