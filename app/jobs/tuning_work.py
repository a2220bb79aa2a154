"""Tuning, for a host process: labelled objects are judged, and parameters are fitted to them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from app.jobs.messages import Event
from app.jobs.service import ForwardingReporter, JobReporter, Service
from core.errors import WorkerError
from core.evaluation.fitting.fitted import FittedParameter
from core.evaluation.fitting.provenance import Provenance
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.search import FitStep
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict, mesh_mark
from core.parameters import Parameters
from core.workers import WorkerPool

STAGE = "judging"


@dataclass(frozen=True)
class JudgingTask:
    """Which objects to judge, and with what.

    Attributes:
        objects: to be judged.
        parameters: of the imagination.
        folder: takes a file for each verdict; made if it is not there yet.
    """

    objects: tuple[LabelledObject, ...]
    parameters: Parameters
    folder: Path


@dataclass(frozen=True)
class VerdictReached:
    """An object is done.

    Attributes:
        folder: that the verdict lies in.
        verdict: what was found.
    """

    folder: Path
    verdict: ObjectVerdict


@dataclass(frozen=True)
class FitTask:
    """What to fit to what; the fields are those of `TuningRequest`.

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
    """A trial is done."""

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


def verdict_file(folder: Path, name: str) -> Path:
    """Return the file of an object's verdict."""
    return folder / f"{name}.json"


class TuningWork(Service):
    """Judges objects side by side and fits parameters, with the same workers.

    Each verdict is on the disk, and reported, as soon as it is reached.
    """

    def __init__(self, send: Callable[[Event], None]) -> None:
        super().__init__(send)
        self._pool = WorkerPool()

    def prepare(self) -> None:
        """Start the workers."""
        from core.imagination.imagination import WORKER_MODULE

        self._pool.start(WORKER_MODULE)

    def close(self) -> None:
        """End the workers."""
        self._pool.close()

    def judge(self, reporter: JobReporter, task: JudgingTask) -> int:
        """Judge all objects of a task and return how many got a verdict, be it that they could not be judged.

        An object that kills its worker gets that as its verdict, and the others go on.
        """
        task.folder.mkdir(parents=True, exist_ok=True)
        for one in task.objects:
            verdict_file(task.folder, one.name).unlink(missing_ok=True)
        verdicts = _VerdictReporter(reporter, task)
        try:
            self._run(task, task.objects, verdicts)
        except WorkerError:
            for one in verdicts.missing():
                self._run_alone(task, one, verdicts)
        verdicts.poll()
        return len(task.objects) - len(verdicts.missing())

    def fit(self, reporter: JobReporter, task: FitTask) -> FitDone:
        """Fit, reporting each trial; if it is cancelled, the best so far is the result.

        Raises:
            PoursightError: nothing can be fitted to these objects; `Cancelled` if nothing was found yet.
        """
        from app.operations.tuning import TuningRequest, tune

        first = task.parameters.seed
        request = TuningRequest(
            task.objects,
            task.source,
            tuple(range(first, first + task.n_seeds)),
            task.parameters,
            task.preset,
            task.fitted,
            task.n_trials,
        )
        found = tune(request, self._pool, reporter, lambda step: reporter.publish(FitStepped(step)))
        return FitDone(found.parameters, found.named, found.provenance, found.is_cut_short)

    def _run(self, task: JudgingTask, objects: Sequence[LabelledObject], verdicts: _VerdictReporter) -> None:
        from core.evaluation.judging import judging_task

        tasks = [judging_task(one, task.parameters, verdict_file(task.folder, one.name)) for one in objects]
        self._pool.run(tasks, STAGE, verdicts)

    def _run_alone(self, task: JudgingTask, one: LabelledObject, verdicts: _VerdictReporter) -> None:
        """Judge an object by itself, so that it is known which one a worker dies of."""
        try:
            self._run(task, (one,), verdicts)
        except WorkerError as error:
            verdict = ObjectVerdict(one.name, mesh_mark(one.mesh), 0, 0, 0.0, str(error))
            verdict.save(verdict_file(task.folder, one.name))
        verdicts.poll()


class _VerdictReporter(ForwardingReporter):
    """Reports also the verdicts that have come."""

    def __init__(self, reporter: JobReporter, task: JudgingTask) -> None:
        super().__init__(reporter)
        self._task = task
        self._reported: set[str] = set()

    def missing(self) -> list[LabelledObject]:
        """Objects without a verdict."""
        self.poll()
        return [one for one in self._task.objects if one.name not in self._reported]

    def poll(self) -> None:
        """Report the verdicts that have come since."""
        for one in self._task.objects:
            file = verdict_file(self._task.folder, one.name)
            if one.name in self._reported or not file.is_file():
                continue
            verdict = ObjectVerdict.load(file)
            if verdict is not None:
                self._reported.add(one.name)
                self._reporter.publish(VerdictReached(self._task.folder, verdict))

    def progress(self, stage: str, done: float, total: float) -> None:  # noqa: ARG002
        """Count the objects that are done; this comes often enough to look for verdicts."""
        self.poll()
        whole = len(self._task.objects)
        share = done / total if total else 0.0
        super().progress(STAGE, max(len(self._reported), share * whole), whole)
