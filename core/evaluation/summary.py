"""The figures of an evaluation as plain JSON; what is not known is null."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from core.evaluation.evaluation import Evaluation
from core.evaluation.intervals import Share
from core.evaluation.statistics import Figures, Margin, agreement_of, sets_of, stage_times
from core.evaluation.tables import figures_of, predicted
from core.evaluation.trials import Trial


def summary_of(evaluation: Evaluation) -> dict[str, Any]:
    """Return the figures of the first variant, and below `variants` those of each."""
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
        "agreement": _agreement_table(evaluation),
    }


def _figures_table(found: Figures) -> dict[str, Any]:
    return {
        "accuracy": found.accuracy.value,
        "auc": found.auc,
        "pour_success_rate": found.pours.value,
        "n": found.accuracy.n,
        "n_objects": len(found.names),
        "confusion": asdict(found.confusion),
        "measure": found.measure,
        "threshold": found.margin.threshold,
        "pours": _share_table(found.pours),
        "right_objects": _share_table(found.right_objects),
        "clean_objects": _share_table(found.clean_objects),
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
    return [{"seed": seed, **_margin_table(found.of_seed(seed).margin)} for seed in found.seeds]


def _margin_table(margin: Margin) -> dict[str, Any]:
    ends = {"smallest_container": margin.smallest_container, "largest_other": margin.largest_other}
    score = margin.measure.lower().replace(" ", "_")  # as the trials' own names
    return {
        **{end: known and {score: known[0], "name": known[1]} for end, known in ends.items()},
        "margin": margin.value,
        "threshold": margin.threshold,
    }


def _trial_table(trial: Trial) -> dict[str, Any]:
    return {
        "variant": trial.variant,
        "name": trial.name,
        "seed": trial.seed,
        "omega": trial.omega,
        "capacity_share": trial.capacity_share,
        "predicted": predicted(trial),
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
