"""Tuning: pours are fitted to measured spills, if there are any, then containability to labels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from app.operations.evaluation.fit_cases import PreparedCases, measure_spills, prepare_cases, prepare_targets
from app.operations.evaluation.placed_object import Input
from core.errors import InputError
from core.evaluation.fitting.containability import ContainabilityResult, ContainabilityStep, FitRequest, fit
from core.evaluation.fitting.fitted import (
    CONTAINABILITY,
    POURING,
    FittedParameter,
    fitted_parameters,
    is_for_spills,
    parameters_of_trial,
    start_values,
    threshold_name,
)
from core.evaluation.fitting.pours import PourResult, PourStep, fit_pours
from core.evaluation.fitting.provenance import Provenance
from core.evaluation.fitting.search import FitResult
from core.evaluation.fitting.spills import SpillMeasurement, read_spills, write_spills
from core.evaluation.labels import LabelledObject, objects_to_fit, read_labels
from core.evaluation.verdicts import measure_by
from core.formats import excerpt
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import TaskRunner
from hardware.simulation.pour_outcome.worlds import WORLDS


@dataclass(frozen=True)
class TuningRequest:
    """What is to be fitted to what.

    Attributes:
        objects: labelled, none ambiguous.
        source: whether the objects are scanned first or their meshes are known.
        seeds: each object is judged with each; a scanned one is scanned with each.
        parameters: to start from.
        preset: what these are called.
        fitted: parameters that follow from labels; the threshold always does.
        n_trials: sets of values to try.
        sampler_seed: of the search.
        spills: measured; none: only labels count.
        spilled_objects: those that the measurements are about.
        fitted_to_spills: parameters that follow from spills.
    """

    objects: tuple[LabelledObject, ...]
    source: Input
    seeds: tuple[int, ...]
    parameters: Parameters
    preset: str
    fitted: tuple[FittedParameter, ...]
    n_trials: int
    sampler_seed: int = 0
    spills: tuple[SpillMeasurement, ...] = ()
    spilled_objects: tuple[LabelledObject, ...] = ()
    fitted_to_spills: tuple[FittedParameter, ...] = ()


@dataclass(frozen=True)
class Tuning:
    """What a request ends with.

    Attributes:
        parameters: found; the threshold among them.
        named: dotted names of what was fitted.
        provenance: where they come from.
        labels: the fit to labels; none if it was stopped before.
        pours: the fit to spills; none if there were none.
    """

    parameters: Parameters
    named: tuple[str, ...]
    provenance: Provenance
    labels: ContainabilityResult | None
    pours: PourResult | None

    @property
    def is_cut_short(self) -> bool:
        """Whether somebody asked to stop."""
        return self.labels is None or self.labels.is_cut_short


def tuning_request(
    folder: Path,
    labels: Path | None,
    start: tuple[str, Parameters],
    source: Input = "scan",
    n_seeds: int = 3,
    n_trials: int = 40,
    parameters: Sequence[str] = (),
    spills: Path | None = None,
    are_spills_to_come: bool = False,
    all_objects: bool = False,
) -> TuningRequest:
    """Read what is needed to fit parameters to a folder of labelled objects.

    Args:
        folder: that holds the meshes.
        labels: the CSV with their labels; none: the one in the folder.
        start: the preset's name, and the parameters to start from.
        source: whether objects are scanned or their meshes are known.
        n_seeds: from the parameters' seed on.
        n_trials: sets of values to try.
        parameters: `NAME` or `NAME=LOW:HIGH` of what is fitted; none: the usual ones.
        spills: a CSV of measured spills, or none.
        are_spills_to_come: whether they will be measured by `with_measured_spills`.
        all_objects: whether all labelled objects are taken, marked for it or not.

    Raises:
        InputError: a file, a parameter or the objects cannot be used.
    """
    preset, values = start
    objects = read_labels(folder, labels)
    chosen = objects_to_fit(objects, all_objects)
    measured = () if spills is None else read_spills(spills)
    has_spills = bool(measured) or are_spills_to_come
    for_labels, for_spills = chosen_parameters(parameters, has_spills)
    return TuningRequest(
        chosen,
        source,
        tuple(range(values.seed, values.seed + n_seeds)),
        values,
        preset,
        for_labels,
        n_trials,
        spills=measured,
        spilled_objects=_spilled_objects(objects, chosen, measured) if has_spills else (),
        fitted_to_spills=for_spills,
    )


def chosen_parameters(
    texts: Sequence[str], has_spills: bool
) -> tuple[tuple[FittedParameter, ...], tuple[FittedParameter, ...]]:
    """Return what is fitted to labels and what to spills; what is named replaces the usual ones of its kind.

    The candy's size belongs to the spills where there are any: they depend on it, labels hardly do.

    Raises:
        InputError: a parameter cannot be fitted, or only to spills that are not there.
    """
    named = fitted_parameters(texts) if texts else ()
    for_spills = tuple(one for one in named if is_for_spills(one)) if has_spills else ()
    for_labels = tuple(one for one in named if one not in for_spills)
    lost = next((one.name for one in for_labels if one.name.startswith("pouring.")), None)
    if lost is not None:
        raise InputError(
            f"{lost} can be fitted to measured spills only: give them, or let the ground-truth simulation "
            "measure them."
        )
    usual = fitted_parameters((), POURING) if has_spills else ()
    return for_labels or fitted_parameters((), CONTAINABILITY), for_spills or usual


def with_measured_spills(
    request: TuningRequest, path: Path, runner: TaskRunner, reporter: Reporter
) -> TuningRequest:
    """Measure spills in the first ground-truth world, write them to a CSV, and return a request with them.

    Raises:
        InputError: the file is there already, or cannot be written.
    """
    if path.exists():
        raise InputError(f"{path} is there already: fit to the spills in it, or name another file.")
    write_spills(path, ())  # refused now, not after the pours
    path.unlink()
    targets = prepare_targets(request.spilled_objects, request.parameters, runner, reporter)
    found = measure_spills(
        request.spilled_objects, targets, request.parameters, WORLDS["bullet"], runner, reporter
    )
    write_spills(path, found)
    return replace(request, spills=found)


def tune(
    request: TuningRequest,
    runner: TaskRunner,
    reporter: Reporter,
    report: Callable[[ContainabilityStep], None],
    report_pours: Callable[[PourStep], None] = lambda _: None,
) -> Tuning:
    """Fit everything that is requested; asked to stop, what was found so far is the result.

    Args:
        request: what to fit.
        runner: where to compute.
        reporter: receives the progress.
        report: called after each trial of the fit to labels.
        report_pours: the same for the fit to spills.

    Raises:
        PoursightError: nothing can be fitted to these objects; `Cancelled` if nothing was found yet.
    """
    if not request.spills:
        return _tune_containability(request, request.parameters, runner, reporter, report)
    targets = prepare_targets(request.spilled_objects, request.parameters, runner, reporter)
    wanted = FitRequest(request.parameters, request.fitted_to_spills, request.n_trials, request.sampler_seed)
    pours = fit_pours(request.spills, targets, wanted, runner, reporter, report_pours)
    best = pours.best
    parameters = parameters_of_trial(request.parameters, request.fitted_to_spills, best.number, best.values)
    if pours.is_cut_short:
        found = Tuning(parameters, (), _provenance(request), None, None)
    else:
        found = _tune_containability(request, parameters, runner, reporter, report)
    return replace(
        found,
        named=(*found.named, *_names(request.fitted_to_spills)),
        provenance=replace(found.provenance, spills=_spills_table(request, pours)),
        pours=pours,
    )


def _spilled_objects(
    objects: tuple[LabelledObject, ...],
    chosen: tuple[LabelledObject, ...],
    spills: tuple[SpillMeasurement, ...],
) -> tuple[LabelledObject, ...]:
    """The objects that were poured into, or that will be in the ground-truth simulation."""
    if not spills:
        return tuple(one for one in chosen if one.label == "container")
    known = {one.name: one for one in objects}
    unknown = next((one.name for one in spills if one.name not in known), None)
    if unknown is not None:
        raise InputError(f"Spills of '{excerpt(unknown)}' are given, but the labels name no such object.")
    names = dict.fromkeys(one.name for one in spills)
    return tuple(known[name] for name in names)


def _tune_containability(
    request: TuningRequest,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
    report: Callable[[ContainabilityStep], None],
) -> Tuning:
    prepared = prepare_cases(request.objects, request.source, request.seeds, parameters, runner, reporter)
    wanted = FitRequest(parameters, request.fitted, request.n_trials, request.sampler_seed)
    result = fit(prepared.cases, wanted, runner, reporter, report)
    best = result.best
    found = parameters_of_trial(parameters, request.fitted, best.number, best.values)
    threshold = threshold_name(found)
    provenance = replace(
        _provenance(request, prepared),
        search=result.to_table(),
        fitted=_fitted_table(request.fitted, parameters, result),
        before=result.start.score.to_table(parameters.containability.deciding_threshold),
        after=best.score.to_table(best.score.threshold),
    )
    return Tuning(
        apply_settings(found, {threshold: best.score.threshold}),
        (*_names(request.fitted), threshold),
        provenance,
        result,
        None,
    )


def _provenance(request: TuningRequest, prepared: PreparedCases | None = None) -> Provenance:
    cases, left_out = ((), {}) if prepared is None else (prepared.cases, prepared.left_out)
    used = {case.name for case in cases}
    labels = {one.name: one.label for one in request.objects if one.name in used}
    measure = measure_by(request.parameters)
    return Provenance(request.source, request.preset, request.seeds, labels, dict(left_out), measure=measure)


def _names(fitted: Sequence[FittedParameter]) -> tuple[str, ...]:
    return tuple(name for one in fitted for name in (one.name, *one.tied))


def _fitted_table(
    fitted: Sequence[FittedParameter], parameters: Parameters, result: FitResult[Any]
) -> tuple[Mapping[str, Any], ...]:
    start = start_values(fitted, parameters)
    return tuple(
        {
            "name": one.name,
            "low": one.low,
            "high": one.high,
            "is_log": one.is_log,
            "tied": list(one.tied),
            "before": start[one.name],
            "after": result.best.values[one.name],
            "importance": round(result.importance[one.name], 4) if one.name in result.importance else None,
        }
        for one in fitted
    )


def _spills_table(request: TuningRequest, pours: PourResult) -> dict[str, Any]:
    return {
        "n": len(request.spills),
        "objects": [one.name for one in request.spilled_objects],
        "search": pours.to_table(),
        "fitted": list(_fitted_table(request.fitted_to_spills, request.parameters, pours)),
        "before": round(pours.start.score.rms, 4),
        "after": round(pours.best.score.rms, 4),
        "bias": round(pours.best.score.bias, 4),
    }
