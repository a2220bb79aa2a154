"""Judging many objects with one set of parameters, for a host process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.jobs.face import JobFace
from app.jobs.messages import News
from app.jobs.service import Service
from core.errors import WorkerError
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict, mesh_mark
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import WorkerPool

STAGE = "calibration"


@dataclass(frozen=True)
class CalibrationTask:
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
    """News: an object is done.

    Attributes:
        folder: that the verdict lies in.
        verdict: what was found.
    """

    folder: Path
    verdict: ObjectVerdict


def verdict_file(folder: Path, name: str) -> Path:
    """Return the file of an object's verdict."""
    return folder / f"{name}.json"


class CalibrationWork(Service):
    """Judges objects side by side; each verdict is on the disk, and told, as soon as it is reached."""

    def __init__(self, tell: Callable[[News], None]) -> None:
        super().__init__(tell)
        self._pool = WorkerPool()

    def prepare(self) -> None:
        """Start the workers."""
        from core.imagination.imagine import WORKER_MODULE

        self._pool.start(WORKER_MODULE)

    def close(self) -> None:
        """End the workers."""
        self._pool.close()

    def judge(self, face: JobFace, task: CalibrationTask) -> int:
        """Judge all objects of a task and return how many got a verdict, be it that they could not be judged.

        An object that kills its worker gets that as its verdict, and the others go on.
        """
        task.folder.mkdir(parents=True, exist_ok=True)
        for one in task.objects:
            verdict_file(task.folder, one.name).unlink(missing_ok=True)
        watch = _VerdictWatch(face, task)
        try:
            self._run(task, task.objects, watch)
        except WorkerError:
            for one in watch.missing():
                self._run_alone(task, one, watch)
        watch.look()
        return len(task.objects) - len(watch.missing())

    def _run(self, task: CalibrationTask, objects: Sequence[LabelledObject], watch: _VerdictWatch) -> None:
        from core.evaluation.judging import judging_task

        tasks = [judging_task(one, task.parameters, verdict_file(task.folder, one.name)) for one in objects]
        self._pool.run(tasks, STAGE, watch)

    def _run_alone(self, task: CalibrationTask, one: LabelledObject, watch: _VerdictWatch) -> None:
        """Judge an object by itself, so that it is known which one a worker dies of."""
        try:
            self._run(task, (one,), watch)
        except WorkerError as error:
            verdict = ObjectVerdict(one.name, mesh_mark(one.mesh), 0, 0, 0.0, str(error))
            verdict.save(verdict_file(task.folder, one.name))
        watch.look()


class _VerdictWatch(Reporter):
    """Passes everything on to the job's face, and tells it of the verdicts that have come."""

    def __init__(self, face: JobFace, task: CalibrationTask) -> None:
        super().__init__()
        self._face = face
        self._task = task
        self._told: set[str] = set()

    def missing(self) -> list[LabelledObject]:
        """Objects without a verdict."""
        self.look()
        return [one for one in self._task.objects if one.name not in self._told]

    def look(self) -> None:
        """Tell of the verdicts that have come since."""
        for one in self._task.objects:
            file = verdict_file(self._task.folder, one.name)
            if one.name in self._told or not file.is_file():
                continue
            verdict = ObjectVerdict.load(file)
            if verdict is not None:
                self._told.add(one.name)
                self._face.tell(VerdictReached(self._task.folder, verdict))

    def progress(self, stage: str, done: float, total: float) -> None:  # noqa: ARG002
        """Count the objects that are done; this comes often enough to look for verdicts."""
        self.look()
        whole = len(self._task.objects)
        share = done / total if total else 0.0
        self._face.progress(STAGE, max(len(self._told), share * whole), whole)

    def warn(self, sentence: str) -> None:
        """Pass it on."""
        self._face.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Ask the face."""
        self._face.raise_if_cancelled()
