"""Trials in worker processes on this machine."""

from __future__ import annotations

import multiprocessing
import os
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

from app.evaluation.engines.engine import MAX_DEATHS, THREADS, Compute, died, faulty, given_up
from app.evaluation.trial import TrialResult, TrialTask, run_trial
from core.progress import Reporter
from core.worker_process import become_worker, children_deaf_to_signals

_POLL_S = 0.1


class LocalEngine:
    """A process for each worker, with a pipe of its own: one that dies takes no other's task with it."""

    def __init__(self, workers: int | None = None, compute: Compute = run_trial) -> None:
        """Prepare `workers` processes, by default one for each processor this process may use."""
        self._workers = workers or len(os.sched_getaffinity(0))
        self._compute = compute

    @property
    def workers(self) -> int:
        """Processes that compute."""
        return self._workers

    def run(self, tasks: Iterable[TrialTask], reporter: Reporter) -> Iterator[tuple[int, TrialResult]]:
        """Yield each task's place and its result as they are finished; see `Engine.run`."""
        waiting = _Waiting(tasks)
        workers: list[_Worker] = []
        try:
            while True:
                self._hand_out(waiting, workers)
                busy = [worker for worker in workers if worker.job is not None]
                if not busy:
                    return
                reporter.raise_if_cancelled()
                ready = wait([worker.connection for worker in busy], timeout=_POLL_S)
                for worker in busy:
                    if worker.connection in ready:
                        yield from self._taken(worker, waiting, workers)
        finally:
            for worker in workers:
                worker.end()

    def _hand_out(self, waiting: _Waiting, workers: list[_Worker]) -> None:
        """Give a job to each idle worker; there are never more of them than jobs."""
        for place in range(self._workers):
            if place < len(workers) and workers[place].job is not None:
                continue
            job = waiting.next()
            if job is None:
                return
            if place == len(workers):
                workers.append(_Worker(self._compute))
            workers[place].give(job)

    def _taken(
        self, worker: _Worker, waiting: _Waiting, workers: list[_Worker]
    ) -> Iterator[tuple[int, TrialResult]]:
        job = worker.job
        if job is None:
            raise AssertionError("only a busy worker answers")
        try:
            answer: TrialResult = worker.connection.recv()
        except (EOFError, OSError):
            workers.remove(worker)
            worker.end()
            job.deaths += 1
            if job.deaths < MAX_DEATHS:
                waiting.again(job)
            else:
                yield job.index, given_up(job.task, died(MAX_DEATHS))
            return
        worker.job = None
        yield job.index, answer


@dataclass
class _Job:
    index: int
    task: TrialTask
    deaths: int = 0


class _Waiting:
    """The jobs that no worker has, those to be done again first."""

    def __init__(self, tasks: Iterable[TrialTask]) -> None:
        self._new = enumerate(tasks)
        self._again: deque[_Job] = deque()

    def next(self) -> _Job | None:
        """Take one; none when there is no more."""
        if self._again:
            return self._again.popleft()
        return next((_Job(index, task) for index, task in self._new), None)

    def again(self, job: _Job) -> None:
        """Take a job back."""
        self._again.append(job)


class _Worker:
    """A process and what it is at."""

    def __init__(self, compute: Compute) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.job: _Job | None = None
        self._process = context.Process(target=_serve, args=(theirs, compute), daemon=True)
        with children_deaf_to_signals(), _one_thread_each():
            self._process.start()
        theirs.close()

    def give(self, job: _Job) -> None:
        """Let it work; that it is dead is found when its answer is fetched."""
        self.job = job
        with suppress(OSError):
            self.connection.send(job.task)

    def end(self) -> None:
        """Kill it."""
        self._process.kill()
        self._process.join()
        self.connection.close()


def _serve(connection: Connection, compute: Compute) -> None:
    """Compute what comes until the parent has gone."""
    become_worker()
    while True:
        try:
            task = connection.recv()
        except EOFError:
            return
        connection.send(_answer(compute, task))


def _answer(compute: Compute, task: TrialTask) -> TrialResult:
    try:
        return compute(task)
    except Exception as error:  # one object must not end the run of all others
        return given_up(task, faulty(error))


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes spawned inside inherit one thread each; libraries read that before any code of ours."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(THREADS)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
