"""Worker processes: where physics and rendering run, so that a crash there is a message, not a lost program.

A pool is started early and reused, because starting costs about a second. Every task is a module-level
function with its arguments; results come back in the order of the tasks whatever the order of completion, so
nothing depends on the number of workers. Cancelling is asked first (an event the tasks look at) and then
enforced.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Protocol

from core.child_process import SPAWN, become_child, children_ignore_signals
from core.errors import Cancelled, Remedy, WorkerError
from core.progress import Reporter

_POLL_S = 0.05
_GRACE_S = 0.5
_PROGRESS_SLOTS = 64


@dataclass(frozen=True)
class Task:
    """A call to be made in a worker; `weight` is its share in the progress shown."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    weight: float = 1.0


Found = Callable[[int, Any], None]
"""Called with a task's index and its result."""


class TaskRunner(Protocol):
    """Runs tasks and hands their results back in order: a `WorkerPool`, or `RunHere`.

    Attributes:
        workers: how many tasks run at a time.
    """

    workers: int

    def run(
        self, tasks: Sequence[Task], stage: str, reporter: Reporter, found: Found | None = None
    ) -> list[Any]:
        """Run all tasks and return their results in order; `found` hears of each as soon as it is there."""
        ...


class RunHere:
    """Runs tasks one after the other in this process, which should be a worker.

    Many objects at once are many tasks already: what each of them computes needs no processes of its own.
    """

    workers = 1

    def run(
        self, tasks: Sequence[Task], stage: str, reporter: Reporter, found: Found | None = None
    ) -> list[Any]:
        """Run all tasks and return their results in order.

        Raises:
            Cancelled: on request.
            Exception: whatever the first failing task raised.
        """
        results = []
        for index, task in enumerate(tasks):
            reporter.raise_if_cancelled()
            reporter.progress(stage, index, len(tasks))
            results.append(task.function(*task.arguments))
            if found is not None:
                found(index, results[-1])
        return results


@dataclass(frozen=True)
class _Channel:
    """What a worker shares with its parent."""

    cancel: Any
    fractions: Any


_channel: _Channel | None = None  # set once per worker process, by its initializer
_slot: int | None = None


def usable_processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


class WorkerPool:
    """A few worker processes (spawned, so that they share no state), used as a context manager."""

    def __init__(self, workers: int | None = None) -> None:
        """Make a pool of `workers` processes, by default one for each processor this process may use."""
        self.workers = workers or usable_processors()
        self._executor: ProcessPoolExecutor | None = None
        self._processes: list[Any] = []
        self._starting: list[Future[Any]] = []
        self._shared = _Channel(SPAWN.Event(), SPAWN.Array("d", _PROGRESS_SLOTS, lock=False))

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def start(self, *modules: str) -> None:
        """Start the processes now, in the background, and let each import `modules`."""
        executor = self._running()
        self._starting += [executor.submit(_import_modules, modules) for _ in range(self.workers)]

    def close(self) -> None:
        """End the processes; a running task is killed."""
        if self._executor is None:
            return
        executor, self._executor = self._executor, None
        for process in self._processes:
            process.kill()
        self._processes = []
        # Waits for the executor's own thread: one that still closes its pipes when Python ends would be woken
        # through a closed one, and that is a traceback on the terminal.
        executor.shutdown()

    def run(
        self, tasks: Sequence[Task], stage: str, reporter: Reporter, found: Found | None = None
    ) -> list[Any]:
        """Run all tasks and return their results in order; `found` hears of each as soon as it is there.

        Raises:
            Cancelled: the reporter was asked to stop.
            WorkerError: a worker process died.
            Exception: whatever the first failing task raised.
        """
        self._shared.cancel.clear()
        self._shared.fractions[:] = [0.0] * _PROGRESS_SLOTS
        futures: list[Future[Any]] = []
        try:
            self._work_through(tasks, futures, stage, reporter, found)
            return [future.result() for future in futures]
        except BrokenProcessPool as error:
            self.close()
            raise WorkerError(
                f"A worker process died during '{stage}' (killed, or out of memory?).", Remedy.FEWER_WORKERS
            ) from error
        except BaseException:
            self._stop_tasks(futures)
            raise

    def _running(self) -> ProcessPoolExecutor:
        if self._executor is None:
            self._children_before = set(multiprocessing.active_children())
            self._executor = ProcessPoolExecutor(
                self.workers, SPAWN, initializer=_initialize, initargs=(self._shared,)
            )
            with children_ignore_signals():
                self._starting = [self._executor.submit(os.getpid) for _ in range(self.workers)]
                self._remember_processes()
        return self._executor

    def _remember_processes(self) -> None:
        self._processes = [
            child for child in multiprocessing.active_children() if child not in self._children_before
        ]

    def _work_through(
        self,
        tasks: Sequence[Task],
        futures: list[Future[Any]],
        stage: str,
        reporter: Reporter,
        found: Found | None,
    ) -> None:
        """Give each process one task at a time, so that nothing waits in the executor.

        What waits there must be cancelled when the work is stopped, and an executor that finds a process dead
        among cancelled tasks breaks: Python then never ends, because arguments are stuck in a pipe.
        """
        total = sum(task.weight for task in tasks)
        executor = self._running()
        pending = {future for future in self._starting if not future.done()}
        while len(futures) < len(tasks) or pending.intersection(futures):
            reporter.raise_if_cancelled()
            with children_ignore_signals():
                while len(pending) < self.workers and len(futures) < len(tasks):
                    slot = len(futures) if len(futures) < _PROGRESS_SLOTS else None
                    futures.append(executor.submit(_call, slot, tasks[len(futures)]))
                    pending.add(futures[-1])
                self._remember_processes()
            finished, pending = wait(pending, timeout=_POLL_S, return_when=FIRST_COMPLETED)
            for future in finished:
                result = future.result()  # a failure ends the run at once
                if found is not None and future in futures:
                    found(futures.index(future), result)
            reporter.progress(stage, self._done(futures, tasks), total)

    def _done(self, futures: list[Future[Any]], tasks: Sequence[Task]) -> float:
        done = 0.0
        for index, future in enumerate(futures):
            if future.done():
                done += tasks[index].weight
            elif index < _PROGRESS_SLOTS:
                done += tasks[index].weight * self._shared.fractions[index]
        return done

    def _stop_tasks(self, futures: list[Future[Any]]) -> None:
        self._shared.cancel.set()
        _, unfinished = wait(futures, timeout=_GRACE_S)
        if unfinished:
            self.close()


def report_fraction(fraction: float) -> None:
    """In a task: report which fraction of it is done, and stop here if the parent asked to.

    Raises:
        Cancelled: the parent asked to stop.
    """
    if _channel is None:
        return
    if _channel.cancel.is_set():
        raise Cancelled("Stopped on request.")
    if _slot is not None:
        _channel.fractions[_slot] = fraction


class WorkerReporter(Reporter):
    """What a stage gets inside a worker: progress goes to the parent, warnings into a list."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[str] = []

    def progress(self, stage: str, done: float, total: float) -> None:  # noqa: ARG002
        """Pass the fraction on."""
        report_fraction(done / total)

    def warn(self, sentence: str) -> None:
        """Collect the sentence for the parent."""
        self.warnings.append(sentence)

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` if the parent asked to stop."""
        if _channel is not None and _channel.cancel.is_set():
            raise Cancelled("Stopped on request.")


def _call(slot: int | None, task: Task) -> Any:
    global _slot
    _slot = slot
    return task.function(*task.arguments)


def _import_modules(modules: tuple[str, ...]) -> None:
    for module in modules:
        importlib.import_module(module)


def _initialize(channel: _Channel) -> None:
    global _channel
    _channel = channel
    become_child()
