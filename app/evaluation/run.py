"""A whole evaluation: what is missing in its folder is computed, and written as soon as it is there."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from filelock import FileLock, Timeout

from app.evaluation.engines.engine import Engine, given_up
from app.evaluation.preparing import EvaluationRequest, PreparedObject, interleaved, prepared_objects
from app.evaluation.trial import TrialResult, TrialTask
from core.errors import Cancelled, InputError, SessionError
from core.evaluation.evaluation import (
    PICTURES_FOLDER,
    Evaluation,
    read_trial,
    trial_file,
    write_trial,
)
from core.evaluation.variants import Variant
from core.parameters import flatten
from core.progress import Reporter
from core.session import explained
from core.session.record import plain, program_versions

STAGE = "evaluation"


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
    objects = prepared_objects(request)
    with explained(folder), _held(folder):
        run = _Run(request, objects, folder)
        try:
            run.finish(engine, reporter)
        except Cancelled as error:
            raise Cancelled(
                "Stopped on request; finished trials are kept, run the same command to continue."
            ) from error
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
            self._seconds_before = _seconds_of(self._folder)
            reporter.warn(_kept_words(self._n_kept))
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
        return job.one.task(self._request, job.seed, job.variants)

    def _missing_variants(self, one: PreparedObject, seed: int) -> tuple[Variant, ...]:
        return tuple(variant for variant in self._request.variants if not self._is_kept(one, seed, variant))

    def _is_kept(self, one: PreparedObject, seed: int, variant: Variant) -> bool:
        """Whether the trial is done; what was made of another input is removed, lest it be taken for it."""
        path, key = self._place(one, seed, variant)
        trial = read_trial(path, key)
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
            unfinished = folder / f".{name}.part"
            unfinished.write_bytes(picture)
            unfinished.replace(folder / name)
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
        ).save(self._folder)


def _kept_words(n_kept: int) -> str:
    if n_kept == 1:
        return "1 trial was finished before and is kept."
    return f"{n_kept} trials were finished before and are kept."


def _seconds_of(folder: Path) -> float:
    """Seconds that the runs before this one took."""
    with suppress(SessionError):
        return Evaluation.load(folder).seconds
    return 0.0


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Make the folder and keep other evaluations out of it.

    Raises:
        InputError: there is a file of that name.
        SessionError: another evaluation is at it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise InputError(
            f"{folder} cannot be made a folder, for there is a file; choose another --out."
        ) from error
    try:
        with FileLock(folder / ".lock", blocking=False):
            yield
    except Timeout as error:
        raise SessionError(
            f"Another evaluation writes into {folder}; wait for it, or choose another --out."
        ) from error
