"""What every engine promises, and the row of a trial that no engine could finish."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Protocol

from app.evaluation.trial import TrialResult, TrialTask
from core.evaluation.trials import Trial
from core.progress import Reporter

Compute = Callable[[TrialTask], TrialResult]
"""A function of a module, so that another process can find it."""
MAX_DEATHS = 2
"""Workers that may die of one task."""
THREADS = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
"""Environment of a worker: each uses one processor, so that as many workers use as many."""


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


def given_up(task: TrialTask, problem: str) -> TrialResult:
    """Return a result that has nothing but its problem, a sentence, for each variant."""
    trials = []
    for variant in task.variants:
        parameters = variant.of(task.parameters)
        threshold = parameters.containability.omega_threshold
        trials.append(
            Trial(
                task.name,
                task.label,
                parameters.seed,
                variant.name,
                threshold,
                n_pour=parameters.pouring.n_pour,
                is_restricted=task.is_restricted,
                problem=problem,
            )
        )
    return TrialResult(tuple(trials))


def faulty(error: BaseException) -> str:
    """Return the problem of a trial that raised what it should not have."""
    return f"A fault of the program ended this ({type(error).__name__}: {error})."


def died(deaths: int) -> str:
    """Return the problem of a trial of which workers died."""
    return (
        f"{deaths} worker processes died of this object (a crash, killed, or out of memory?); the same "
        "command tries it again, with fewer workers if memory is short."
    )
