"""The report of an evaluation: one HTML file that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from core.evaluation.best_view import view_accuracies
from core.evaluation.comparing import default_parameters, parameter_changes
from core.evaluation.evaluation import Evaluation
from core.evaluation.pages.cards import TROUBLES, State, cards_of, state_of
from core.evaluation.pages.charts import histogram, roc_curve, roc_sentence
from core.evaluation.statistics import Figures, agreement_of, figures_of, sets_of, stage_times
from core.evaluation.tables import (
    DECLINED_NOTE,
    INTERVALS_NOTE,
    MEASURES_NOTE,
    best_view_sentence,
    classification,
    declined_text,
    interval_text,
    paper_rows,
    percent,
    pouring,
    signed,
    table_rows,
    title_of,
    truth_sentence,
    world_rows,
)
from core.evaluation.trials import Trial, measure_word
from core.resources import RESOURCES

SET_TITLES = {
    "all": "all objects",
    "restricted": "restricted",
    "calibration": "calibration",
    "other": "other than calibration",
    "full": "full",
}
STAGE_TITLES = {
    "mesh": "reading the mesh",
    "scan": "scan and reconstruction",
    "collision": "collision model",
    "containability": "containability imagination",
    "judgement": "imagined filling",
    "retention": "imagined tilting",
    "verdict": "imagined filling and tilting",  # as evaluations of earlier versions call it
    "pouring": "pouring imagination",
    "risk": "pours with errors of the set-up",
    "outcome": "pours in the ground-truth simulation",
}


def report_page(evaluation: Evaluation, folder: Path) -> str:
    """Return the report's HTML.

    Args:
        evaluation: with its trials.
        folder: that holds the pictures.
    """
    first = evaluation.variants[0]
    found = figures_of(evaluation, first)
    cards = cards_of(evaluation, first, folder)
    rows = [*table_rows(evaluation), *paper_rows()]
    return render(
        "evaluation.html.j2",
        {
            "evaluation": evaluation,
            "title": title_text(evaluation),
            "variant_titles": [title_of(variant) for variant in evaluation.variants],
            "set_titles": SET_TITLES,
            "found": found,
            "other": _figures_of_set(evaluation, "other"),
            "verdict": _verdict(found),
            "remarks": _remarks(evaluation, found),
            "duration": duration_text(evaluation.seconds),
            "mean_s": _mean_seconds(evaluation.of_variant(first)),
            "classification": classification(rows),
            "pouring": pouring(rows),
            "world_rows": world_rows(evaluation),
            "intervals_note": INTERVALS_NOTE,
            "declined_note": DECLINED_NOTE,
            "declined_text": declined_text,
            "measures_note": MEASURES_NOTE,
            "troubles": _troubles(evaluation),
            "charts": _charts(found),
            "other_charts": [
                (title_of(variant), other, _charts(other))
                for variant, other in _other_measures(evaluation, found)
            ],
            "seeds": [(seed, found.of_seed(seed)) for seed in found.seeds],
            "wrong": [card for card in cards if card.state in TROUBLES],
            "right": [card for card in cards if card.state == "right"],
            "ambiguous": [card for card in cards if card.state == "ambiguous"],
            "agreement": agreement_of(evaluation.objects),
            "parameter_rows": parameter_changes(default_parameters(), evaluation.parameters),
            "stage_rows": [
                (STAGE_TITLES.get(stage, stage), times)
                for stage, times in stage_times(evaluation.of_variant(first)).items()
            ],
        },
    )


def title_text(evaluation: Evaluation) -> str:
    """Say what was evaluated, in a heading's words."""
    n, seeds = len(evaluation.objects), evaluation.seeds
    source = {"scan": "scanned", "mesh": "given as meshes"}.get(evaluation.source, evaluation.source)
    count = f"{n} object{'s' if n != 1 else ''}"
    tried = "one seed" if len(seeds) == 1 else f"{len(seeds)} seeds"
    return f"{count}, {source}, {tried}"


def duration_text(seconds: float) -> str:
    """Return a time as a person would say it."""
    if seconds < 120:
        return f"{seconds:.1f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 120 else f"{minutes // 60} h {minutes % 60} min"


def render(template: str, data: Mapping[str, Any]) -> str:
    """Return the HTML of a template of `resources/evaluation`; all text in it is escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader([RESOURCES / "evaluation", RESOURCES / "report"]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "percent": percent,
        "interval": interval_text,
        "signed": signed,
        "word": measure_word,
    }
    return environment.get_template(template).render(data)


def _charts(found: Figures) -> tuple[str, str | None, str]:
    """The histogram, the ROC curve (none without both labels), and what the curve says at the threshold."""
    curve = roc_curve(found)
    return histogram(found), curve, "" if curve is None else roc_sentence(found)


def _mean_seconds(trials: Sequence[Trial]) -> float | None:
    return sum(trial.total_s for trial in trials) / len(trials) if trials else None


def _figures_of_set(evaluation: Evaluation, name: str) -> Figures | None:
    members = sets_of(evaluation.objects).get(name)
    return None if members is None else figures_of(evaluation, evaluation.variants[0], members)


def _verdict(found: Figures) -> str:
    judged, poured = found.accuracy, found.pours
    if not judged.n:
        return "No labelled object was tried."
    said = f"{judged.count} of {judged.n} judgements agree with the labels ({percent(judged.value)} %)"
    if not poured.n:
        return f"{said}; there was no container to pour into."
    return (
        f"{said}, and {poured.count} of {poured.n} pours into containers spilled nothing "
        f"({percent(poured.value)} %)."
    )


def _other_measures(evaluation: Evaluation, found: Figures) -> list[tuple[str, Figures]]:
    """The first variant that is judged by what the method is not, and its figures; none if none is."""
    others = [(variant, figures_of(evaluation, variant)) for variant in evaluation.variants[1:]]
    return [pair for pair in others if pair[1].measure != found.measure][:1]


def _remarks(evaluation: Evaluation, found: Figures) -> list[str]:
    """What a reader must know before believing the figures."""
    remarks = []
    n_all = len(evaluation.objects) * len(evaluation.seeds) * len(evaluation.variants)
    missing = n_all - len(evaluation.trials)
    if missing:
        remarks.append(f"{missing} of {n_all} trials are not done yet: the figures are of the others.")
    margin = found.margin.value
    if margin is not None and margin <= 0:
        what = measure_word(found.measure)
        remarks.append(f"Containers and others overlap in {what}: no threshold judges all of them right.")
    if evaluation.truth:
        remarks.append(truth_sentence(evaluation.truth))
    for variant in evaluation.variants:
        views = view_accuracies(evaluation.of_variant(variant))
        if views is not None:
            remarks.append(f"{title_of(variant)}: {best_view_sentence(views)}")
    failed = found.confusion.failed
    if failed:
        what = "judgement failed and counts" if failed == 1 else "judgements failed and count"
        remarks.append(f"{failed} {what} as not right.")
    undecided = found.confusion.undecided
    if undecided:
        remarks.append(
            f"For {undecided} of {len(found.trials)} the program cannot tell, which counts as not right."
        )
    return remarks


def _troubles(evaluation: Evaluation) -> list[tuple[str, list[str], list[str], list[str]]]:
    """Return (variant, misjudged, spilled, failed), with the number of seeds where there are several."""
    rows = []
    for variant in evaluation.variants:
        names: dict[State, list[str]] = {}
        for trial in evaluation.of_variant(variant):
            names.setdefault(state_of(trial), []).append(trial.name)
        misjudged, spilled, failed = (
            _counted(names.get(state, []), len(evaluation.seeds)) for state in TROUBLES
        )
        rows.append((title_of(variant), misjudged, spilled, failed))
    return rows


def _counted(names: list[str], n_seeds: int) -> list[str]:
    # the spaces keep the count in one line
    return [
        f"{name} ({names.count(name)}\N{NO-BREAK SPACE}of\N{NO-BREAK SPACE}{n_seeds})"
        if n_seeds > 1
        else name
        for name in dict.fromkeys(names)
    ]
