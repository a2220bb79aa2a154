"""A whole calibration: pours to measured spills, if there are any, then containability to labels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from app.evaluation.fitting.preparing import PreparedCases, prepare_cases, prepare_targets
from app.evaluation.standing import Input
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
from core.evaluation.fitting.spills import SpillMeasurement
from core.evaluation.fitting.trials import FitResult
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import measure_by
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import TaskRunner


@dataclass(frozen=True)
class CalibrationWish:
    """What is to be fitted to what.

    Attributes:
        objects: labelled, none ambiguous.
        source: whether the objects are scanned first or their meshes are known.
        seeds: each object is judged with each; a scanned one is scanned with each.
        parameters: to start from.
        preset: what these are called.
        fitted: parameters that labels tell; the threshold always is.
        n_trials: sets of values to try.
        sampler_seed: of the search.
        spills: measured; none: only labels count.
        spilled_objects: those that the measurements are about.
        fitted_to_spills: parameters that spills tell.
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
class Calibration:
    """What a calibration ends with.

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


def chosen_parameters(
    texts: Sequence[str], has_spills: bool
) -> tuple[tuple[FittedParameter, ...], tuple[FittedParameter, ...]]:
    """Return what is fitted to labels and what to spills; what is named replaces the usual ones of its kind.

    The candy's size belongs to the spills where there are any: they measure it, labels do not.

    Raises:
        InputError: a parameter cannot be fitted, or only to spills that are not there.
    """
    named = fitted_parameters(texts) if texts else ()
    for_spills = tuple(one for one in named if is_for_spills(one)) if has_spills else ()
    for_labels = tuple(one for one in named if one not in for_spills)
    lost = next((one.name for one in for_labels if one.name.startswith("pouring.")), None)
    if lost is not None:
        raise InputError(f"{lost} is told by spills only: give them by --spills or --spills-from-truth.")
    usual = fitted_parameters((), POURING) if has_spills else ()
    return for_labels or fitted_parameters((), CONTAINABILITY), for_spills or usual


def calibrate(
    wish: CalibrationWish,
    runner: TaskRunner,
    reporter: Reporter,
    tell: Callable[[ContainabilityStep], None],
    tell_pours: Callable[[PourStep], None] | None = None,
) -> Calibration:
    """Fit everything that is wished for; asked to stop, what was found so far is the result.

    Args:
        wish: what to fit.
        runner: where to compute.
        reporter: receives the progress.
        tell: told after each trial of the fit to labels.
        tell_pours: the same for the fit to spills.

    Raises:
        PoursightError: nothing can be fitted to these objects; `Cancelled` if nothing was found yet.
    """
    parameters, pours = wish.parameters, None
    if wish.spills:
        pours = _fit_pours(wish, runner, reporter, tell_pours or _tell_nobody)
        best = pours.best
        parameters = parameters_of_trial(parameters, wish.fitted_to_spills, best.number, best.values)
        if pours.is_cut_short:
            provenance = replace(_provenance(wish), spills=_spills_table(wish, pours))
            return Calibration(parameters, _names(wish.fitted_to_spills), provenance, None, pours)
    prepared = prepare_cases(wish.objects, wish.source, wish.seeds, parameters, runner, reporter)
    labels = fit(
        prepared.cases,
        FitRequest(parameters, wish.fitted, wish.n_trials, wish.sampler_seed),
        runner,
        reporter,
        tell,
    )
    found = _fitted_to_labels(wish, parameters, labels, prepared)
    if pours is None:
        return found
    named = (*found.named, *_names(wish.fitted_to_spills))
    return replace(
        found,
        named=named,
        provenance=replace(found.provenance, spills=_spills_table(wish, pours)),
        pours=pours,
    )


def _fitted_to_labels(
    wish: CalibrationWish, parameters: Parameters, result: ContainabilityResult, prepared: PreparedCases
) -> Calibration:
    """Sum up a fit to labels."""
    best = result.best
    found = parameters_of_trial(parameters, wish.fitted, best.number, best.values)
    before = parameters.containability.deciding_threshold
    provenance = replace(
        _provenance(wish, prepared),
        search=result.to_table(),
        fitted=_fitted_table(wish.fitted, parameters, result),
        before=result.start.score.to_table(before),
        after=best.score.to_table(best.score.threshold),
    )
    threshold = threshold_name(found)
    named = (*_names(wish.fitted), threshold)
    with_threshold = apply_settings(found, {threshold: best.score.threshold})
    return Calibration(with_threshold, named, provenance, result, None)


def _fit_pours(
    wish: CalibrationWish, runner: TaskRunner, reporter: Reporter, tell: Callable[[PourStep], None]
) -> PourResult:
    targets = prepare_targets(wish.spilled_objects, wish.parameters, runner, reporter)
    request = FitRequest(wish.parameters, wish.fitted_to_spills, wish.n_trials, wish.sampler_seed)
    return fit_pours(wish.spills, targets, request, runner, reporter, tell)


def _tell_nobody(step: PourStep) -> None:
    pass


def _provenance(wish: CalibrationWish, prepared: PreparedCases | None = None) -> Provenance:
    cases, left_out = ((), {}) if prepared is None else (prepared.cases, prepared.left_out)
    used = {case.name for case in cases}
    labels = {one.name: one.label for one in wish.objects if one.name in used}
    measure = measure_by(wish.parameters)
    return Provenance(wish.source, wish.preset, wish.seeds, labels, dict(left_out), measure=measure)


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
            "importance": _rounded(result.importance.get(one.name)),
        }
        for one in fitted
    )


def _spills_table(wish: CalibrationWish, pours: PourResult) -> dict[str, Any]:
    return {
        "n": len(wish.spills),
        "objects": [one.name for one in wish.spilled_objects],
        "search": pours.to_table(),
        "fitted": list(_fitted_table(wish.fitted_to_spills, wish.parameters, pours)),
        "before": round(pours.start.score.rms, 4),
        "after": round(pours.best.score.rms, 4),
        "bias": round(pours.best.score.bias, 4),
    }


def _rounded(share: float | None) -> float | None:
    return None if share is None else round(share, 4)
