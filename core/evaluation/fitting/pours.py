"""Fitting what decides a pour to measured spills (Sec. IV-C: P should match what is really poured in)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.collision import CollisionModel
from core.errors import InputError
from core.evaluation.fitting.containability import FitRequest
from core.evaluation.fitting.fitted import parameters_of_trial, start_values
from core.evaluation.fitting.progress import PartReporter
from core.evaluation.fitting.search import search
from core.evaluation.fitting.spills import SpillMeasurement
from core.evaluation.fitting.trials import FitResult, FitStep, FitTrial
from core.imagination.body import BodyFile, body_files
from core.imagination.containability import object_at_rest
from core.imagination.cup import cup_parts
from core.imagination.packing import CupRun, pack_cup, packing_task
from core.imagination.pouring import pivots_m
from core.imagination.pours import Pour, PourOutcome, replay_task
from core.imagination.results import Footprint
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import Task, TaskRunner

STAGE = "fitting pours"
_CUP = "cup"
_CUP_SHARE = 0.3
"""Of a trial's progress; the rest is the pours'."""


@dataclass(frozen=True)
class PourTarget:
    """An object that was poured into, as it stood.

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
    tell: Callable[[PourStep], None],
    judge: JudgePours | None = None,
) -> PourResult:
    """Find the values with which the imagined spills are nearest to the measured ones.

    Cup and object are imagined one after the other (`pouring.mode` "replay"), which tells candies that stayed
    in the cup from spilled ones.

    Args:
        measurements: at least one.
        targets: by the objects' names.
        request: what to fit.
        runner: where to compute.
        reporter: receives the progress; asked to stop, what was found so far is the result.
        tell: told after each trial.
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
    with _bodies(targets, request.parameters) as files:
        used = judge or _Imagining(rows, files, runner)

        def judged(number: int, values: Mapping[str, float], _best: FitTrial[PourScore] | None) -> PourScore:
            parameters = parameters_of_trial(request.parameters, request.fitted, number, values)
            part = PartReporter(reporter, STAGE, number, 1, n_trials)
            return PourScore(tuple(used(parameters, part)), measured)

        return search(request.fitted, start, judged, request.n_trials, request.sampler_seed, tell)


@dataclass(frozen=True)
class _Row:
    """A measurement with everything that is needed to imagine it."""

    body: str
    target: PourTarget
    pour: Pour
    spilled: float
    n_pour: int
    seed: int

    @classmethod
    def of(cls, one: SpillMeasurement, targets: Mapping[str, PourTarget], parameters: Parameters) -> _Row:
        target = targets.get(one.name)
        if target is None:
            known = ", ".join(targets) or "none"
            raise InputError(
                f"Spills of '{one.name}' are given, but no such object can be poured into here; "
                f"known: {known}."
            )
        n_pour = parameters.pouring.n_pour if one.n_pour is None else one.n_pour
        if one.spilled > n_pour:
            raise InputError(
                f"{one.spilled:g} of {n_pour} candies cannot have been spilled at '{one.name}'; give the "
                "column n_pour or set pouring.n_pour."
            )
        pivot = pivots_m(target.footprint, np.array([one.theta_rad]), np.array([one.indent_m]))[0, 0]
        seed = parameters.seed if one.seed is None else one.seed
        return cls(
            _body_name(one.name, targets), target, Pour(pivot, one.theta_rad), one.spilled, n_pour, seed
        )

    def of_parameters(self, parameters: Parameters) -> Parameters:
        """The parameters as they hold for this row."""
        pouring = parameters.pouring.model_copy(update={"n_pour": self.n_pour, "mode": "replay"})
        return parameters.model_copy(update={"seed": self.seed, "pouring": pouring})


class _Imagining:
    """Imagines all rows: first the cup alone, once for each number of candies and seed, then the pours."""

    def __init__(self, rows: Sequence[_Row], files: Mapping[str, BodyFile], runner: TaskRunner) -> None:
        self._rows = rows
        self._files = files
        self._runner = runner
        self._of_row = [(row.n_pour, row.seed) for row in rows]

    def __call__(self, parameters: Parameters, reporter: Reporter) -> list[float]:
        runs = self._cup_runs(parameters, PartReporter(reporter, STAGE, 0, _CUP_SHARE, 1))
        tasks: list[Task] = []
        for row, key in zip(self._rows, self._of_row, strict=True):
            own = row.of_parameters(parameters)
            target = object_at_rest(row.target.model, self._files[row.body], own)
            tasks += [replay_task(target, run, row.pour.T_world_E, own, False) for run in runs[key]]
        part = PartReporter(reporter, STAGE, _CUP_SHARE, 1 - _CUP_SHARE, 1)
        outcomes: list[PourOutcome] = self._runner.run(tasks, STAGE, part)
        n_packings = parameters.pouring.n_packings
        grouped = _grouped(outcomes, n_packings)
        return [float(np.mean([outcome.n_spilled for outcome in found])) for found in grouped]

    def _cup_runs(self, parameters: Parameters, reporter: Reporter) -> dict[tuple[int, int], list[CupRun]]:
        n_packings = parameters.pouring.n_packings
        firsts = {key: row for row, key in zip(self._rows, self._of_row, strict=True)}
        tasks = [
            packing_task(self._files[_CUP], row.of_parameters(parameters), packing)
            for row in firsts.values()
            for packing in range(n_packings)
        ]
        runs = _grouped(self._runner.run(tasks, STAGE, reporter), n_packings)
        return dict(zip(firsts, runs, strict=True))


def _bodies(
    targets: Mapping[str, PourTarget], parameters: Parameters
) -> AbstractContextManager[dict[str, BodyFile]]:
    bodies: dict[str, Any] = {
        _body_name(name, targets): (one.model.parts, not one.model.is_convex) for name, one in targets.items()
    }
    return body_files(**bodies | {_CUP: (cup_parts(parameters.pouring.cup), False)})


def _body_name(name: str, targets: Mapping[str, PourTarget]) -> str:
    """Name of a body's file, whatever the object is called."""
    return f"object_{list(targets).index(name)}"


def _grouped(found: Sequence[Any], size: int) -> list[list[Any]]:
    return [list(found[k : k + size]) for k in range(0, len(found), size)]
