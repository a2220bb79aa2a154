"""Where trials are computed: what every engine promises, and worker processes on this machine."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Protocol

from app.operations.evaluation.trial import TrialResult, TrialTask, fault_sentence, given_up, run_trial
from core.child_process import ChildProcess
from core.progress import Reporter

Compute = Callable[[TrialTask], TrialResult]
"""A function of a module, so that another process can find it."""
MAX_DEATHS = 2
"""Workers that may die of one task."""
THREADS = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
"""Environment of a worker: each uses one processor, so that as many workers use as many."""
_POLL_S = 0.1


class Engine(Protocol):
    """Computes trials, each in a process that does nothing else at the time."""

    @property
    def workers(self) -> int:
        """How many workers the newest run used, or the next one will."""
        ...

    def run(self, tasks: Iterable[TrialTask], reporter: Reporter) -> Iterator[tuple[int, TrialResult]]:
        """Yield each task's place and its result as they are finished, in any order.

        A task that fails, or of which `MAX_DEATHS` workers died, becomes a result that says so. The tasks
        are taken from the iterable when there is a worker for them. Closing the iterator ends the work.

        Raises:
            Cancelled: the reporter was asked to stop.
            WorkerError: no worker can be had.
        """
        ...


def death_sentence(deaths: int) -> str:
    """Return the problem of a trial of which workers died."""
    return (
        f"{deaths} worker processes died of this object (a crash, killed, or out of memory?); it is "
        "tried again when the evaluation is continued; use fewer workers if memory is short."
    )


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
        idle: list[_Worker] = []
        busy: list[_Worker] = []
        try:
            while True:
                while len(busy) < self._workers and (job := waiting.next()) is not None:
                    worker = idle.pop() if idle else _Worker(self._compute)
                    worker.give(job)
                    busy.append(worker)
                if not busy:
                    return
                reporter.raise_if_cancelled()
                ready = wait([worker.connection for worker in busy], timeout=_POLL_S)
                for worker in [one for one in busy if one.connection in ready]:
                    busy.remove(worker)
                    result = worker.take()
                    if result is not None:
                        idle.append(worker)
                        yield worker.job.index, result
                    elif worker.job.deaths < MAX_DEATHS:
                        waiting.again(worker.job)
                    else:
                        yield worker.job.index, given_up(worker.job.task, death_sentence(MAX_DEATHS))
        finally:
            for worker in busy + idle:
                worker.end()


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
    """A process, and the job that it has or had last."""

    job: _Job

    def __init__(self, compute: Compute) -> None:
        self._child = ChildProcess(_serve, compute, name="trials", environment=THREADS)
        self.connection = self._child.connection

    def give(self, job: _Job) -> None:
        """Let it work; that it is dead is found when its answer is fetched."""
        self.job = job
        with suppress(OSError):
            self.connection.send(job.task)

    def take(self) -> TrialResult | None:
        """Fetch the result; none if the worker died, which is then counted."""
        try:
            result: TrialResult = self.connection.recv()
        except (EOFError, OSError):
            self.end()
            self.job.deaths += 1
            return None
        return result

    def end(self) -> None:
        """Kill it."""
        self._child.end()


def _serve(connection: Connection, compute: Compute) -> None:
    """Compute what comes until the parent has gone."""
    while True:
        try:
            task: TrialTask = connection.recv()
        except EOFError:
            return
        try:
            connection.send(compute(task))
        except Exception as error:  # one object must not end the run of all others
            connection.send(given_up(task, fault_sentence(error)))
