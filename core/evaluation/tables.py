"""Tables I and II of the paper and the rows of the CSV files, as values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from core.evaluation.evaluation import Evaluation
from core.evaluation.intervals import Interval, Share, auc_interval
from core.evaluation.statistics import Figures, sets_of
from core.evaluation.trials import Measure, Trial, measure_of, measure_word
from core.evaluation.variants import VARIANTS

CSV_COLUMNS = (
    *("id", "label", "omega", "predicted", "p_chosen", "poured", "spilled", "seconds"),
    *("seed", "variant", "category", "restricted", "calibration"),
    *("n_drop", "n_in", "measure", "threshold", "capacity_share", "capacity_candies", "capacity_ml"),
    *("holds_rad", "choice_i", "choice_j", "clean_at_least", "n_tries", "problem"),
)
INTERVALS_NOTE = (
    "In brackets 95 % intervals (Wilson; of the AUC: Newcombe). They take trials and pours as independent; "
    "those of one object are not, so with several seeds or pours the true intervals are wider."
)

MEASURES_NOTE = (
    "Capacity share: the volume that an imagined filling leaves in the object, as a share of its convex "
    "hull's. Omega: the share of the candies dropped on it that stay."
)


def truth_sentence(truth: Mapping[str, Any]) -> str:
    """Say which settings of the truth world (SI units) are not the usual ones."""
    chosen = ", ".join(
        f"{name} = {value:.4g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in truth.items()
    )
    return f"The truth world was not the usual one: {chosen}."


@dataclass(frozen=True)
class ClassificationRow:
    """A row of Table I.

    Attributes:
        variant: its short name.
        method: in the paper's words.
        dataset: name of the set of objects.
        n_objects: labelled objects.
        accuracy: trials judged right.
        right_objects: objects judged right with every seed; none where that is not known.
        auc: from 0 to 1; none if there is only one label.
        auc_interval: 95 %.
        measure: what judges; none where it is neither.
        threshold: of the measure; none where there is no measure.
        is_from_paper: whether it is the paper's own, on its own objects.
    """

    variant: str
    method: str
    dataset: str
    n_objects: int
    accuracy: Share
    right_objects: Share | None
    auc: float | None
    auc_interval: Interval | None
    measure: Measure | None
    threshold: float | None
    is_from_paper: bool = False

    @property
    def rule(self) -> str:
        """What makes a container, such as 'Omega > 0.13'; empty where it is neither measure."""
        if self.measure is None or self.threshold is None:
            return ""
        return f"{measure_word(self.measure)} > {self.threshold:.4g}"


@dataclass(frozen=True)
class PouringRow:
    """A row of Table II.

    Attributes:
        variant: its short name.
        method: in the paper's words.
        dataset: name of the set of objects.
        n_objects: labelled containers.
        pours: pours without a spilled candy.
        clean_objects: containers of which no pour spilled a candy; none where that is not known.
        is_from_paper: whether it is the paper's own, on its own objects.
    """

    variant: str
    method: str
    dataset: str
    n_objects: int
    pours: Share
    clean_objects: Share | None
    is_from_paper: bool = False


def title_of(variant: str) -> str:
    """Return a variant's title; one that this version does not know keeps its name."""
    return VARIANTS[variant].title if variant in VARIANTS else variant


def figures_of(evaluation: Evaluation, variant: str, names: frozenset[str] | None = None) -> Figures:
    """Return the figures of a variant, of all objects or of those named."""
    trials = evaluation.of_variant(variant)
    named = (trial for trial in trials if names is None or trial.name in names)
    # A set in which all failed is judged as the others of its variant are.
    return replace(Figures.of(named, evaluation.n_pours), measure=measure_of(trials))


def classification_rows(evaluation: Evaluation) -> list[ClassificationRow]:
    """Return Table I: set by set, in each all variants."""
    return [
        ClassificationRow(
            variant,
            title_of(variant),
            name,
            len(found.names),
            found.accuracy,
            found.right_objects,
            found.auc,
            found.auc_interval,
            found.measure,
            found.margin.threshold,
        )
        for name, variant, found in _figures_by_set(evaluation)
    ]


def pouring_rows(evaluation: Evaluation) -> list[PouringRow]:
    """Return Table II: set by set, in each all variants; a set without containers has none."""
    return [
        PouringRow(
            variant,
            title_of(variant),
            name,
            found.clean_objects.n,
            found.pours,
            found.clean_objects,
        )
        for name, variant, found in _figures_by_set(evaluation)
        if found.pours.n
    ]


def paper_classification() -> list[ClassificationRow]:
    """Return the paper's Table I, with the intervals that its numbers of objects give."""
    return [
        ClassificationRow(
            variant,
            method,
            dataset,
            n_containers + n_others,
            Share(n_right, n_containers + n_others),
            None,
            1.0,
            auc_interval(1.0, n_containers, n_others),
            None if threshold is None else "Omega",
            threshold,
            is_from_paper=True,
        )
        for variant, method, dataset, n_containers, n_others, n_right, threshold in (
            ("affordancenet", "AffordanceNet", "restricted", 23, 28, 51, None),
            ("imagination", "Imagination", "restricted", 23, 28, 51, 0.0),
            ("imagination", "Imagination", "full", 55, 75, 125, 0.0),
        )
    ]


def paper_pouring() -> list[PouringRow]:
    """Return the paper's Table II: one pour for each container."""
    return [
        PouringRow(variant, method, dataset, n, Share(count, n), None, is_from_paper=True)
        for variant, method, dataset, count, n in (
            ("affordancenet", "AffordanceNet", "restricted", 19, 23),
            ("affordancenet-3d", "AffordanceNet w/ 3D Scanning", "restricted", 21, 23),
            ("fixed-theta", "Imagination w/ fixed theta", "restricted", 23, 23),
            ("imagination", "Imagination", "restricted", 23, 23),
            ("fixed-theta", "Imagination w/ fixed theta", "full", 52, 55),
            ("imagination", "Imagination", "full", 54, 55),
        )
    ]


def csv_rows(evaluation: Evaluation, trials: Iterable[Trial]) -> Iterator[tuple[object, ...]]:
    """Yield one row a trial, with `CSV_COLUMNS`."""
    objects = {one.name: one for one in evaluation.objects}
    for trial in trials:
        i, j = trial.choice or ("", "")
        yield (
            trial.name,
            trial.label,
            _cell(trial.omega),
            predicted(trial),
            _cell(trial.p_chosen),
            trial.n_pours,
            sum(trial.spilled),
            round(trial.total_s, 3),
            trial.seed,
            trial.variant,
            objects[trial.name].category,
            int(objects[trial.name].is_restricted),
            int(objects[trial.name].is_calibration),
            *(trial.n_drop, trial.n_in, "" if trial.score is None else trial.measure, trial.threshold),
            *map(_cell, (trial.capacity_share, trial.capacity_candies, trial.capacity_ml, trial.holds_rad)),
            *(i, j, _cell(trial.clean_at_least), trial.n_tries, trial.problem),
        )


def predicted(trial: Trial) -> str:
    """Return what it was judged, in the words of the labels; empty if it failed."""
    return {True: "container", False: "non-container", None: ""}[trial.is_judged_container]


def _cell(value: float | None) -> float | str:
    return "" if value is None else round(value, 6)


def _figures_by_set(evaluation: Evaluation) -> Iterator[tuple[str, str, Figures]]:
    for name, members in sets_of(evaluation.objects).items():
        for variant in evaluation.variants:
            yield name, variant, figures_of(evaluation, variant, members)
