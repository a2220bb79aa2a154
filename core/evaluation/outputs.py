"""What an evaluation's folder holds for people and for other programs.

report.html   the tables, the curves and every object, in one file that needs nothing else
tables.txt    Tables I and II as they are printed
objects.csv   one row an object and seed, of the first variant
trials.csv    the same of all variants
summary.json  the figures; what is not known is null
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from core.evaluation.evaluation import Evaluation
from core.evaluation.statistics import (
    Figures,
    Share,
    agreement_of,
    capacity_figures,
    figures_of,
    sets_of,
    stage_times,
)
from core.evaluation.tables import text_tables
from core.evaluation.trials import Trial
from core.files import write_json, write_whole
from core.session.explaining import explained

REPORT_FILE, TABLES_FILE = "report.html", "tables.txt"
OBJECTS_FILE, TRIALS_FILE, SUMMARY_FILE = "objects.csv", "trials.csv", "summary.json"
_COLUMNS = (
    *("id", "label", "omega", "predicted", "p_chosen", "poured", "spilled", "seconds"),
    *("seed", "variant", "category", "restricted", "calibration"),
    *("n_drop", "n_in", "measure", "threshold", "capacity_share", "capacity_candies", "capacity_ml"),
    *("capacity_least_ml", "capacity_most_ml"),
    *("holds_rad", "choice_i", "choice_j", "clean_at_least", "declined", "n_tries", "n_feasible", "problem"),
)


def write_outputs(evaluation: Evaluation, folder: Path) -> Path:
    """Write the tables and the report of an evaluation.

    Args:
        evaluation: with its trials.
        folder: that also holds the pictures.

    Returns:
        The report's path.

    Raises:
        SessionError: the disk is full or the folder may not be written.
    """
    from core.evaluation.pages.report import report_page

    first = evaluation.of_variant(evaluation.variants[0])
    with explained(folder):
        write_whole(folder / OBJECTS_FILE, _csv(evaluation, first))
        write_whole(folder / TRIALS_FILE, _csv(evaluation, evaluation.trials))
        write_whole(folder / TABLES_FILE, text_tables(evaluation))
        write_json(folder / SUMMARY_FILE, summary_of(evaluation))
        write_whole(folder / REPORT_FILE, report_page(evaluation, folder))
    return folder / REPORT_FILE


def summary_of(evaluation: Evaluation) -> dict[str, Any]:
    """Return the figures of the first variant, and below `variants` those of each, as plain JSON."""
    first = evaluation.variants[0]
    found = figures_of(evaluation, first)
    return {
        **_figures_table(found),
        "seconds": evaluation.seconds,
        "variant": first,
        "source": evaluation.source,
        "seeds": list(evaluation.seeds),
        "workers": evaluation.workers,
        "seconds_by_stage": {
            stage: asdict(times) for stage, times in stage_times(evaluation.of_variant(first)).items()
        },
        "margins": _margins_table(found),
        "per_seed": [{"seed": seed, **_figures_table(found.of_seed(seed))} for seed in found.seeds],
        "sets": _sets_table(evaluation, first),
        "variants": {
            variant: {
                **_figures_table(figures_of(evaluation, variant)),
                "margins": _margins_table(figures_of(evaluation, variant)),
                "sets": _sets_table(evaluation, variant),
            }
            for variant in evaluation.variants
        },
        "ambiguous": [_trial_table(one) for one in evaluation.trials if one.label == "ambiguous"],
        "stray_pours": [_trial_table(one) for one in found.stray_pours],
        "failed": [_trial_table(one) | {"problem": one.problem} for one in evaluation.trials if one.problem],
        "undecided": [_trial_table(one) for one in evaluation.trials if one.is_undecided],
        "agreement": _agreement_table(evaluation),
        "capacity": _capacity_table(evaluation, first),
    }


def _capacity_table(evaluation: Evaluation, variant: str) -> dict[str, Any] | None:
    found = capacity_figures(evaluation, variant)
    if found is None:
        return None
    return {"within_10_percent": _share_table(found.near), "within_bounds": _share_table(found.within)}


def _figures_table(found: Figures) -> dict[str, Any]:
    shares = {
        "pours": found.pours,
        "right_objects": found.right_objects,
        "declined": found.declined,
        "clean_objects": found.clean_objects,
    }
    return {
        "accuracy": found.accuracy.value,
        "auc": found.auc,
        "pour_success_rate": found.pours.value,
        "n": found.accuracy.n,
        "n_objects": len(found.names),
        "confusion": asdict(found.confusion),
        "measure": found.measure,
        "threshold": found.threshold,
        **{name: _share_table(share) for name, share in shares.items()},
        "intervals": {
            "accuracy": found.accuracy.interval,
            "auc": found.auc_interval,
            "pour_success_rate": found.pours.interval,
            "right_objects": found.right_objects.interval,
            "clean_objects": found.clean_objects.interval,
        },
    }


def _share_table(share: Share) -> dict[str, Any]:
    return {"count": share.count, "n": share.n, "share": share.value}


def _sets_table(evaluation: Evaluation, variant: str) -> dict[str, Any]:
    return {
        name: _figures_table(figures_of(evaluation, variant, members))
        for name, members in sets_of(evaluation.objects).items()
    }


def _margins_table(found: Figures) -> list[dict[str, Any]]:
    score = found.measure.lower().replace(" ", "_")  # as the trials' own names
    rows = []
    for seed in found.seeds:
        one = found.of_seed(seed)
        ends = asdict(one.margin)
        rows.append(
            {
                "seed": seed,
                **{end: known and {score: known[0], "name": known[1]} for end, known in ends.items()},
                "margin": one.margin.value,
                "threshold": one.threshold,
            }
        )
    return rows


def _trial_table(trial: Trial) -> dict[str, Any]:
    return {
        "variant": trial.variant,
        "name": trial.name,
        "seed": trial.seed,
        "omega": trial.omega,
        "capacity_share": trial.capacity_share,
        "predicted": trial.predicted,
        "poured": trial.n_pours,
        "spilled": sum(trial.spilled),
    }


def _agreement_table(evaluation: Evaluation) -> dict[str, Any] | None:
    found = agreement_of(evaluation.objects)
    if found is None:
        return None
    return {
        "mean_share": found.mean_share,
        "n_objects": {f"{agreed} of {asked}": n for (agreed, asked), n in found.n_objects.items()},
    }


def _csv(evaluation: Evaluation, trials: Iterable[Trial]) -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(_COLUMNS)
    table.writerows(_csv_row(evaluation, trial) for trial in trials)
    return text.getvalue()


def _csv_row(evaluation: Evaluation, trial: Trial) -> tuple[object, ...]:
    one = next(one for one in evaluation.objects if one.name == trial.name)
    i, j = trial.choice or ("", "")
    return (
        *(trial.name, trial.label, _cell(trial.omega), trial.predicted, _cell(trial.p_chosen)),
        *(trial.n_pours, sum(trial.spilled), round(trial.total_s, 3)),
        *(trial.seed, trial.variant, one.category, int(one.is_restricted), int(one.is_calibration)),
        *(trial.n_drop, trial.n_in, "" if trial.score is None else trial.measure, trial.threshold),
        *map(_cell, (trial.capacity_share, trial.capacity_candies, trial.capacity_ml)),
        *map(_cell, (trial.capacity_least_ml, trial.capacity_most_ml, trial.holds_rad)),
        *(
            i,
            j,
            _cell(trial.clean_at_least),
            int(trial.is_declined),
            trial.n_tries,
            _cell(trial.n_feasible),
            trial.problem,
        ),
    )


def _cell(value: float | None) -> float | str:
    return "" if value is None else round(value, 6)
