"""Fitting parameters to labelled objects, for a host process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.jobs.calibration_work import CalibrationWork
from app.jobs.face import JobFace
from core.evaluation.fitting.fitted import FittedParameter
from core.evaluation.fitting.provenance import Provenance
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.trials import FitStep
from core.evaluation.labels import LabelledObject
from core.parameters import Parameters


@dataclass(frozen=True)
class FitTask:
    """What to fit to what; the fields are those of `CalibrationWish`.

    Attributes:
        objects: labelled, none ambiguous.
        source: whether they are scanned first or their meshes are known.
        n_seeds: each object is judged with so many, from that of the parameters on.
        parameters: to start from.
        preset: what these started from.
        fitted: the parameters to be fitted; the threshold always is.
        n_trials: sets of values to try.
    """

    objects: tuple[LabelledObject, ...]
    source: Literal["mesh", "scan"]
    n_seeds: int
    parameters: Parameters
    preset: str
    fitted: tuple[FittedParameter, ...]
    n_trials: int


@dataclass(frozen=True)
class FitStepped:
    """News: a trial is done."""

    step: FitStep[FitScore]


@dataclass(frozen=True)
class FitDone:
    """What a fit ends with.

    Attributes:
        parameters: found; the threshold among them.
        named: dotted names of what was fitted.
        provenance: where they come from.
        is_cut_short: whether somebody asked to stop.
    """

    parameters: Parameters
    named: tuple[str, ...]
    provenance: Provenance
    is_cut_short: bool


class FitWork(CalibrationWork):
    """Fits with the same workers that judge."""

    def fit(self, face: JobFace, task: FitTask) -> FitDone:
        """Fit, telling each trial; asked to stop, the best so far is the result.

        Raises:
            PoursightError: nothing can be fitted to these objects; `Cancelled` if nothing was found yet.
        """
        from app.evaluation.fitting.calibrating import CalibrationWish, calibrate

        first = task.parameters.seed
        wish = CalibrationWish(
            task.objects,
            task.source,
            tuple(range(first, first + task.n_seeds)),
            task.parameters,
            task.preset,
            task.fitted,
            task.n_trials,
        )
        found = calibrate(wish, self._pool, face, lambda step: face.tell(FitStepped(step)))
        return FitDone(found.parameters, found.named, found.provenance, found.is_cut_short)
