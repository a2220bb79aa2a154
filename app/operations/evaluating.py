"""A whole evaluation: what is missing in its folder is computed, and written as soon as it is there."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from app.operations.evaluation.engine import Engine
from app.operations.evaluation.placed_object import Input
from app.operations.evaluation.trial import TrialResult, TrialTask, given_up
from core.appearance.network import weights_digest
from core.errors import Cancelled, InputError, Remedy, SessionError
from core.evaluation.evaluation import (
    PICTURES_FOLDER,
    EvaluatedObject,
    Evaluation,
    digest_of,
    kept_trial,
    trial_file,
    write_trial,
)
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.variants import Variant
from core.files import make_folder, write_whole
from core.formats import excerpt
from core.parameters import Parameters, flatten
from core.progress import Reporter
from core.scratch import remove_left
from core.session import explained
from core.session.record import plain, program_versions
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS

STAGE = "evaluation"
RESULT_VERSION = 7
"""Raise it when the same input gives another result: trials that were kept are then done again."""
_DECISIVE = ("numpy", "pybullet", "mujoco-core", "open3d")


@dataclass(frozen=True)
class EvaluationRequest:
    """What is to be evaluated, and how.

    Attributes:
        objects: folder with meshes.
        labels: the CSV with their labels; none: the one in the folder.
        source: whether each object is scanned first or its mesh is known.
        seeds: each object is tried once with each.
        variants: in the tables' order.
        n_pours: pours for each object that is judged a container, into the ground-truth worlds in turn.
        preset: what the parameters started from.
        parameters: of the method; each trial has its own seed instead of theirs.
        worlds: settings of the ground-truth worlds, by name.
    """

    objects: Path
    labels: Path | None
    source: Input
    seeds: tuple[int, ...]
    variants: tuple[Variant, ...]
    n_pours: int
    preset: str
    parameters: Parameters
    worlds: Mapping[str, OutcomeSettings] = field(default_factory=WORLDS.copy)

    @property
    def truth(self) -> dict[str, Any]:
        """Settings of the worlds that are not their usual ones, by name."""
        changed: dict[str, Any] = {}
        for name, world in self.worlds.items():
            usual = WORLDS[name].model_dump(mode="json")
            changed |= {key: one for key, one in world.model_dump(mode="json").items() if one != usual[key]}
        return changed

    def seeded(self, seed: int) -> Parameters:
        """Return the parameters of the trials with one seed."""
        return self.parameters.model_copy(update={"seed": seed})

    def key(self, sha256: str, seed: int, variant: Variant) -> str:
        """Return the digest of all that one trial depends on."""
        versions = program_versions()
        looks = {"by_looks": variant.by_looks, "weights": weights_digest()} if variant.by_looks else {}
        return digest_of(
            looks
            | {
                "mesh": sha256,
                "source": self.source,
                "parameters": plain(flatten(variant.of(self.seeded(seed)))),
                "has_arm": variant.has_arm,
                "worlds": {name: one.model_dump(mode="json") for name, one in self.worlds.items()},
                "n_pours": self.n_pours,
                "result": RESULT_VERSION,
                "versions": {name: versions[name] for name in _DECISIVE},
            }
        )


@dataclass(frozen=True)
class PreparedObject:
    """An object of which it is known whether its mesh can be read.

    Attributes:
        labelled: as the labels say.
        evaluated: as tables and pages need it, with its file's digest.
        problem: why there is no mesh, in a sentence; empty if there is one.
    """

    labelled: LabelledObject
    evaluated: EvaluatedObject
    problem: str

    @classmethod
    def of(cls, one: LabelledObject) -> PreparedObject:
        """Read the object's file.

        Raises:
            InputError: its name cannot be that of a file.
        """
        if Path(one.name).name != one.name:
            raise InputError(
                f"The labels name an object '{excerpt(one.name)}', which cannot be a file's name; rename it."
            )
        try:
            content, problem = one.mesh.read_bytes(), ""
        except OSError as error:
            content = None
            problem = f"{one.mesh} cannot be read ({error.strerror}); put the object's mesh there."
        return cls(one, EvaluatedObject.of(one, content), problem)

    def content(self) -> bytes:
        """Read the mesh's file again; there is none of an object with a problem.

        Raises:
            InputError: the file is not what it was when the evaluation began.
        """
        if self.problem:
            return b""
        with suppress(OSError):
            content = self.labelled.mesh.read_bytes()
            if EvaluatedObject.of(self.labelled, content) == self.evaluated:
                return content
        raise InputError(f"{self.labelled.mesh} has changed since the evaluation began.", Remedy.RUN_AGAIN)


def prepared_objects(request: EvaluationRequest) -> tuple[PreparedObject, ...]:
    """Read the labels and every mesh's digest, in the order of the labels.

    Raises:
        InputError: the labels cannot be used, or a name cannot be that of a file.
    """
    return tuple(PreparedObject.of(one) for one in read_labels(request.objects, request.labels))


def interleaved(objects: Sequence[PreparedObject]) -> tuple[PreparedObject, ...]:
    """Spread each kind of label evenly: containers cost most, and progress predicts the time that is left."""
    kinds: dict[str, list[PreparedObject]] = {}
    for one in objects:
        kinds.setdefault(one.labelled.label, []).append(one)
    ranked = [((place + 0.5) / len(kind), one) for kind in kinds.values() for place, one in enumerate(kind)]
    return tuple(one for _, one in sorted(ranked, key=lambda pair: pair[0]))


def evaluate(request: EvaluationRequest, engine: Engine, folder: Path, reporter: Reporter) -> Evaluation:
    """Evaluate labelled objects into a folder; what it holds already, from the same input, is not repeated.

    Trials that could not be judged are tried again. Trials in the folder that were made of another input are
    replaced.

    Args:
        request: the objects, and how to try them.
        engine: where to compute; it does not decide the results.
        folder: is made if there is none.
        reporter: receives the progress.

    Raises:
        InputError: the labels cannot be used, or there is no cluster where the engine looks for it.
        SessionError: another program is at the folder, or it cannot be written.
        WorkerError: the cluster has gone; finished trials are kept.
        Cancelled: the reporter was asked to stop; finished trials are kept.
    """
    remove_left()
    objects = prepared_objects(request)
    with explained(folder), _held(folder):
        run = _Run(request, objects, folder)
        try:
            run.finish(engine, reporter)
        except Cancelled as error:
            raise Cancelled("Stopped on request; finished trials are kept.", Remedy.CONTINUE) from error
        return Evaluation.load(folder)


@dataclass(frozen=True)
class _Missing:
    """What remains to be done of one object with one seed."""

    one: PreparedObject
    seed: int
    variants: tuple[Variant, ...]


class _Run:
    """One run of an evaluation; those before it may have done a part."""

    def __init__(self, request: EvaluationRequest, objects: tuple[PreparedObject, ...], folder: Path) -> None:
        self._request, self._objects, self._folder = request, objects, folder
        self._began_s = time.perf_counter()
        self._seconds_before = 0.0
        self._n_kept = 0

    def finish(self, engine: Engine, reporter: Reporter) -> None:
        """Do what is missing."""
        missing = [
            _Missing(one, seed, variants)
            for seed in self._request.seeds
            for one in interleaved(self._objects)
            if (variants := self._missing_variants(one, seed))
        ]
        if self._n_kept:
            with suppress(SessionError):
                self._seconds_before = Evaluation.load(self._folder).seconds
            counted = "1 trial was" if self._n_kept == 1 else f"{self._n_kept} trials were"
            kept = "is kept" if self._n_kept == 1 else "are kept"
            reporter.warn(f"{counted} finished before and {kept}.")
        self._save(engine.workers)
        for job in missing:
            if job.one.problem:
                self._write(job, given_up(self._task(job), job.one.problem))
        self._compute([job for job in missing if not job.one.problem], engine, reporter)

    def _compute(self, jobs: list[_Missing], engine: Engine, reporter: Reporter) -> None:
        if not jobs:
            return
        reporter.progress(STAGE, 0, len(jobs))
        tasks = (self._task(job) for job in jobs)
        for done, (index, result) in enumerate(engine.run(tasks, reporter), 1):
            self._write(jobs[index], result)
            self._save(engine.workers)
            reporter.progress(STAGE, done, len(jobs))

    def _task(self, job: _Missing) -> TrialTask:
        one, request = job.one.labelled, self._request
        return TrialTask(
            one.name,
            one.label,
            one.is_restricted,
            job.one.content(),
            one.mesh.suffix,
            request.source,
            request.seeded(job.seed),
            job.variants,
            request.worlds,
            request.n_pours,
        )

    def _missing_variants(self, one: PreparedObject, seed: int) -> tuple[Variant, ...]:
        return tuple(variant for variant in self._request.variants if not self._is_kept(one, seed, variant))

    def _is_kept(self, one: PreparedObject, seed: int, variant: Variant) -> bool:
        """Whether the trial is done; what was made of another input is removed, lest it be taken for it."""
        path, key = self._place(one, seed, variant)
        trial = kept_trial(path, key)
        if trial is None or trial.problem:
            path.unlink(missing_ok=True)
            return False
        labelled = one.labelled
        known = replace(trial, label=labelled.label, is_restricted=labelled.is_restricted)
        if known != trial:  # labels decide nothing that is computed
            write_trial(self._folder, known, key)
        self._n_kept += 1
        return True

    def _place(self, one: PreparedObject, seed: int, variant: Variant) -> tuple[Path, str]:
        path = trial_file(self._folder, one.labelled.name, seed, variant.name)
        return path, self._request.key(one.evaluated.sha256, seed, variant)

    def _write(self, job: _Missing, result: TrialResult) -> None:
        """Write pictures and trials, the trial last: where it is, its picture is too."""
        folder = self._folder / PICTURES_FOLDER
        folder.mkdir(exist_ok=True)
        for name, picture in result.pictures.items():
            write_whole(folder / name, picture)
        for variant, trial in zip(job.variants, result.trials, strict=True):
            _, key = self._place(job.one, job.seed, variant)
            write_trial(self._folder, trial, key)

    def _save(self, workers: int) -> None:
        request = self._request
        Evaluation(
            tuple(one.evaluated for one in self._objects),
            request.source,
            request.seeds,
            tuple(variant.name for variant in request.variants),
            request.n_pours,
            request.preset,
            plain(flatten(request.parameters)),
            program_versions(),
            self._seconds_before + time.perf_counter() - self._began_s,
            workers,
            truth=request.truth,
            worlds=tuple(request.worlds),
        ).save(self._folder)


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Make the folder and keep other evaluations out of it.

    Raises:
        InputError: there is a file of that name.
        SessionError: another evaluation is at it.
    """
    make_folder(folder)
    try:
        with FileLock(folder / ".lock", blocking=False):
            yield
    except Timeout as error:
        raise SessionError(
            f"Another evaluation writes into {folder}; wait for it, or choose another folder."
        ) from error
