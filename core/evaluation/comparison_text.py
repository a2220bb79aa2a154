"""A comparison in words and rows of text, for the terminal and for the page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from textwrap import fill

from core.evaluation.comparing import TURNS, Comparison, ObjectPair, Turn, VariantPair
from core.evaluation.intervals import Share
from core.evaluation.plain_text import (
    WIDTH,
    interval_text,
    margin_sentence,
    percent,
    share_text,
    signed,
    text_table,
)
from core.evaluation.statistics import Figures
from core.evaluation.trials import Measure, measure_word

TURN_TITLES: dict[Turn, str] = {
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


def figure_rows(pair: VariantPair) -> list[FigureRow]:
    """Return the figures of a variant, with their intervals."""
    before, after = pair.figures
    margins = before.margin, after.margin
    measures = pair.measures
    return [
        _share_row("accuracy, %", before.accuracy, after.accuracy),
        _share_row("objects right with every seed, %", before.right_objects, after.right_objects),
        FigureRow("AUC, %", _auc_text(before), _auc_text(after), _difference(before.auc, after.auc, 2, 100)),
        _share_row("pours without a spilled candy, %", before.pours, after.pours),
        _share_row("containers without any spill, %", before.clean_objects, after.clean_objects),
        _score_row(f"margin of {measures_text(measures)}", margins[0].value, margins[1].value, measures),
        _score_row("threshold", margins[0].threshold, margins[1].threshold, measures),
        _number_row("seconds of work a trial", *pair.seconds, 2),
    ]


def turn_sentence(one: ObjectPair, turn: Turn) -> str:
    """Say how an object turned, such as 'mug: right 5 of 5, now 3 of 5; Omega 0.310, now 0.020'."""
    is_judged = turn in ("judged worse", "judged better")
    before, after = one.right if is_judged else one.clean
    word = "right" if is_judged else "clean"
    old, new = ("unknown" if score is None else f"{score:.3f}" for score in one.score)
    measures = [measure_word(measure) for measure in one.measures]
    is_same = measures[0] == measures[1]
    return (
        f"{one.name}: {word} {before.count} of {before.n}, now {after.count} of {after.n}; "
        f"{measures[0]} {old}, now {new if is_same else f'{measures[1]} {new}'}"
    )


def measures_text(measures: tuple[Measure, Measure]) -> str:
    """Say what judged before and after, such as 'Omega' or 'Omega, now of capacity share'."""
    before, after = (measure_word(measure) for measure in measures)
    return before if before == after else f"{before}, now of {after}"


def margin_sentences(pair: VariantPair) -> list[str]:
    """Say before and after which container has the smallest score and which non-container the largest."""
    words = ("Before", "After")
    return [
        f"{word}: {margin_sentence(found.margin)}." for word, found in zip(words, pair.figures, strict=True)
    ]


def pair_title(pair: VariantPair) -> str:
    """Return what is compared with what."""
    return pair.after if pair.before == pair.after else f"{pair.before} before, {pair.after} after"


def comparison_text(found: Comparison) -> str:
    """Return the comparison as plain text, at most `WIDTH` characters wide."""
    parts = [_changes_text(found), *(_variant_text(pair) for pair in found.variants)]
    notes = {
        "Only before": found.only_before,
        "Only after": found.only_after,
        "Labelled otherwise": [f"{name} ({old}, now {new})" for name, old, new in found.relabelled],
        "Another mesh": found.other_meshes,
    }
    parts += [_wrapped(f"{title}: {', '.join(names)}") for title, names in notes.items() if names]
    return "\n\n".join(parts) + "\n"


def _changes_text(found: Comparison) -> str:
    changes = [f"{what}: {old}, now {new}" for what, old, new in found.settings]
    changes += [f"{name}: {old}, now {new}" for name, old, new, _ in found.parameters]
    if not changes:
        return "Settings and parameters are the same."
    return _lines("What was changed:", changes)


def _variant_text(pair: VariantPair) -> str:
    rows = [(row.name, row.before, row.after, row.difference) for row in figure_rows(pair)]
    table = text_table((pair_title(pair), "before", "after", "difference"), rows, n_words=1)
    turned = [
        _lines(f"{TURN_TITLES[turn]}:", [turn_sentence(one, turn) for one in pair.turned(turn)])
        for turn in TURNS
        if pair.turned(turn)
    ]
    margins = "\n".join(_wrapped(sentence) for sentence in margin_sentences(pair))
    return "\n\n".join([table, margins, *(turned or ["No object flipped."])])


def _lines(title: str, sentences: Iterable[str]) -> str:
    return "\n".join([title, *(_wrapped(f"  {sentence}") for sentence in sentences)])


def _wrapped(text: str) -> str:
    return fill(text, WIDTH, subsequent_indent="    ")


def _share_row(name: str, before: Share, after: Share) -> FigureRow:
    return FigureRow(
        name,
        share_text(before),
        share_text(after),
        _difference(before.value, after.value, 2, 100),
    )


def _auc_text(found: Figures) -> str:
    return f"{percent(found.auc)} {interval_text(found.auc_interval)}".rstrip()


def _number_row(name: str, before: float | None, after: float | None, decimals: int) -> FigureRow:
    old, new = ("–" if one is None else f"{one:.{decimals}f}".replace("-", "−") for one in (before, after))
    return FigureRow(name, old, new, _difference(before, after, decimals))


def _score_row(
    name: str, before: float | None, after: float | None, measures: tuple[Measure, Measure]
) -> FigureRow:
    """Of a score or its threshold: what is measured otherwise has no difference."""
    row = _number_row(name, before, after, 3)
    return row if measures[0] == measures[1] else replace(row, difference="")


def _difference(before: float | None, after: float | None, decimals: int, scale: float = 1) -> str:
    if before is None or after is None:
        return ""
    value = round(scale * (after - before), decimals)
    return signed(value, decimals) if value else "same"
