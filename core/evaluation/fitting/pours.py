"""Fitting what decides a pour to measured spills (Sec. IV-C: P should match what is really poured in)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.collision import CollisionModel
from core.errors import InputError
from core.evaluation.fitting.containability import FitRequest
from core.evaluation.fitting.fitted import parameters_of_trial, start_values
from core.evaluation.fitting.search import FitResult, FitStep, FitTrial, PartReporter, search
from core.evaluation.fitting.spills import SpillMeasurement
from core.formats import excerpt
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns
from core.imagination.packing import pack_cup
from core.imagination.pours import Pour, pivots_m, replay_task
from core.imagination.results import Footprint
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import TaskRunner

STAGE = "fitting pours"
_CUP_SHARE = 0.3
"""Of a trial's progress; the rest is the pours'."""


@dataclass(frozen=True)
class PourTarget:
    """An object that was poured into, as it was placed.

    Attributes:
        model: its body.
        footprint: the indentations are measured from its centre.
    """

    model: CollisionModel
    footprint: Footprint


@dataclass(frozen=True)
class PourScore:
    """How far imagined spills are from measured ones.

    Attributes:
        spilled: (N,) imagined, a row each: mean over the packings.
        measured: (N,).
    """

    spilled: tuple[float, ...]
    measured: tuple[float, ...]
    is_given_up: bool = False

    @property
    def rms(self) -> float:
        """Root of the mean squared difference, in candies."""
        return float(np.sqrt(np.mean(np.square(np.subtract(self.spilled, self.measured)))))

    @property
    def bias(self) -> float:
        """Mean of imagined less measured, in candies."""
        return float(np.mean(np.subtract(self.spilled, self.measured)))

    @property
    def rank(self) -> tuple[float]:
        """The smaller the difference the better."""
        return (-self.rms,)

    @property
    def objective(self) -> float:
        """What the search maximises."""
        return -self.rms


PourStep = FitStep[PourScore]
PourResult = FitResult[PourScore]
JudgePours = Callable[[Parameters, Reporter], Sequence[float]]


def fit_pours(
    measurements: Sequence[SpillMeasurement],
    targets: Mapping[str, PourTarget],
    request: FitRequest,
    runner: TaskRunner,
    reporter: Reporter,
    report: Callable[[PourStep], None],
    judge: JudgePours | None = None,
) -> PourResult:
    """Find the values with which the imagined spills are nearest to the measured ones.

    Cup and object are imagined one after the other (`pouring.mode` "replay"), which tells apart candies
    that stayed in the cup and spilled ones.

    Args:
        measurements: at least one.
        targets: by the objects' names.
        request: what to fit.
        runner: where to compute.
        reporter: receives the progress; asked to stop, what was found so far is the result.
        report: called after each trial.
        judge: returns the spilled candies of each measurement; none: by imagination.

    Raises:
        InputError: an object is unknown, or more candies were spilled than are poured.
        StageError: the cup cannot hold the candies.
        Cancelled: somebody asked to stop before the first trial was done.
        WorkerError: a worker died.
    """
    rows = [_Row.of(one, targets, request.parameters) for one in measurements]
    measured = tuple(row.spilled for row in rows)
    n_trials = request.n_trials if request.fitted else 1
    start = start_values(request.fitted, request.parameters)
    for row in rows:
        pack_cup(row.of_parameters(request.parameters), 0)  # refused before hours of work
    imagined = judge or _Imagining(rows, ImaginationContext(request.parameters, runner, reporter))

    def judged(number: int, values: Mapping[str, float], _best: FitTrial[PourScore] | None) -> PourScore:
        parameters = parameters_of_trial(request.parameters, request.fitted, number, values)
        part = PartReporter(reporter, STAGE, number, 1, n_trials)
        return PourScore(tuple(imagined(parameters, part)), measured)

    return search(request.fitted, start, judged, request.n_trials, request.sampler_seed, report)


@dataclass(frozen=True)
class _Row:
    """A measurement with everything that is needed to imagine it."""

    target: PourTarget
    pour: Pour
    spilled: float
    n_pour: int
    seed: int

    @classmethod
    def of(cls, one: SpillMeasurement, targets: Mapping[str, PourTarget], parameters: Parameters) -> _Row:
        target = targets.get(one.name)
        if target is None:
            known = excerpt(", ".join(targets)) or "none"
            raise InputError(
                f"Spills of '{excerpt(one.name)}' are given, but no such object can be poured into here; "
                f"known: {known}."
            )
        n_pour = parameters.pouring.n_pour if one.n_pour is None else one.n_pour
        if one.spilled > n_pour:
            raise InputError(
                f"{one.spilled:g} of {n_pour} candies cannot have been spilled at '{excerpt(one.name)}'; "
                "give the column n_pour or set pouring.n_pour."
            )
        plane_E = target.footprint.raised(parameters.pouring.pivot_height_m)
        pivot = pivots_m(plane_E, np.array([one.theta_rad]), np.array([one.indent_m]))[0, 0]
        seed = parameters.seed if one.seed is None else one.seed
        return cls(target, Pour(pivot, one.theta_rad), one.spilled, n_pour, seed)

    def of_parameters(self, parameters: Parameters) -> Parameters:
        """The parameters as they hold for this row."""
        pouring = parameters.pouring.model_copy(update={"n_pour": self.n_pour, "mode": "replay"})
        return parameters.model_copy(update={"seed": self.seed, "pouring": pouring})


class _Imagining:
    """Imagines all rows: first the cup alone, once for each number of candies and seed, then the pours."""

    def __init__(self, rows: Sequence[_Row], context: ImaginationContext) -> None:
        self._rows = rows
        self._context = context

    def __call__(self, parameters: Parameters, reporter: Reporter) -> list[float]:
        cups = replace(self._context, reporter=PartReporter(reporter, STAGE, 0, _CUP_SHARE, 1))
        pours = replace(self._context, reporter=PartReporter(reporter, STAGE, _CUP_SHARE, 1 - _CUP_SHARE, 1))
        own = [row.of_parameters(parameters) for row in self._rows]
        runs = self._cup_runs(own, cups)
        tasks = []
        for row, its in zip(self._rows, own, strict=True):
            context = pours.reading(its)
            target, cup_runs = context.target(row.target.model), runs.of_packings(context)
            tasks += [replay_task(target, run, row.pour.T_world_E, its, False) for run in cup_runs]
        spilled = [outcome.n_spilled for outcome in pours.run(tasks, STAGE)]
        by_row = np.reshape(spilled, (len(self._rows), parameters.pouring.n_packings))
        means: list[float] = by_row.mean(axis=1).tolist()
        return means

    @staticmethod
    def _cup_runs(own: Sequence[Parameters], context: ImaginationContext) -> CupRuns:
        """The runs that the rows need, all side by side."""
        runs = CupRuns()
        first, *others = {(its.pouring.n_pour, its.seed): its for its in own}.values()
        for its in others:
            runs.prepare(context.reading(its))
        runs.of_packings(context.reading(first))
        return runs
