"""The page that compares two evaluations: one HTML file that needs nothing else."""

from __future__ import annotations

from typing import Any

from core.evaluation.comparing import TURNS, Comparison, VariantPair
from core.evaluation.comparison_text import (
    TURN_TITLES,
    figure_rows,
    margin_sentences,
    measures_text,
    turn_sentence,
)
from core.evaluation.evaluation import Evaluation
from core.evaluation.pages.charts import scatter
from core.evaluation.pages.rendering import render
from core.evaluation.pages.report import title_text
from core.evaluation.tables import INTERVALS_NOTE, MEASURES_NOTE, title_of

TEMPLATE = "comparison.html.j2"


def comparison_page(found: Comparison, before: Evaluation, after: Evaluation) -> str:
    """Return the comparison's HTML."""
    return render(
        TEMPLATE,
        {
            "found": found,
            "before": title_text(before),
            "after": title_text(after),
            "variants": [_variant_data(pair) for pair in found.variants],
            "intervals_note": INTERVALS_NOTE,
            "measures_note": MEASURES_NOTE,
        },
    )


def _variant_data(pair: VariantPair) -> dict[str, Any]:
    titles = title_of(pair.before), title_of(pair.after)
    thresholds = pair.figures[0].margin.threshold, pair.figures[1].margin.threshold
    scores = ((one, *one.score) for one in pair.objects)
    known = [
        (one.name, one.label, old, new) for one, old, new in scores if old is not None and new is not None
    ]
    return {
        "title": titles[1] if titles[0] == titles[1] else f"{titles[0]} before, {titles[1]} after",
        "n_objects": len(pair.objects),
        "rows": figure_rows(pair),
        "margins": margin_sentences(pair),
        "turns": [
            (TURN_TITLES[turn], [turn_sentence(one, turn) for one in pair.turned(turn)])
            for turn in TURNS
            if pair.turned(turn)
        ],
        "scatter": scatter(known, thresholds, pair.measures),
        "measures": measures_text(pair.measures),
    }
