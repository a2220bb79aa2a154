"""Trials on a Dask cluster: machines that have the program installed, or workers on this one."""

from __future__ import annotations

import asyncio
import logging
import os
import pickle
import threading
import time
import uuid
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from app.operations.evaluation.engine import MAX_DEATHS, THREADS, Compute, death_sentence
from app.operations.evaluation.trial import TrialResult, TrialTask, fault_sentence, given_up, run_trial
from core.errors import InputError, Remedy, WorkerError
from core.formats import excerpt
from core.progress import Reporter
from core.quiet import quiet
from core.session.record import program_versions

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

_CONNECT_S = 5
_POLL_S = 0.05
_COUNT_EVERY_S = 1.0
_WARN_AFTER_S = 10.0
_REPLENISH_S = 1.0
_START_S = 60
"""Longer than a worker takes to start on a busy machine: one that takes longer, or is away as long, hangs."""
_LARGEST_MESH = "1GB"
"""Dask warns of what is larger than this."""
_ALONE = threading.Lock()
"""PyBullet and its output are a process's, so two trials in one process wait for each other."""


@contextmanager
def local_cluster(workers: int | None, port: int) -> Iterator[tuple[str, int]]:
    """Run a scheduler and workers on this machine; they end with this process, however it ends.

    Args:
        workers: worker processes; by default one for each processor this process may use.
        port: of the scheduler, on loopback; 0: any that is free.

    Yields:
        The scheduler's address, and the number of its workers.

    Raises:
        InputError: the port is taken.
    """
    n_workers = workers or len(os.sched_getaffinity(0))
    with _started(n_workers, port) as cluster, _replenished(cluster, n_workers):
        yield cluster.scheduler_address, n_workers


class DaskEngine:
    """One task at a time for each worker of a cluster, also for those that join later.

    More in flight would spare the workers a short wait for the next mesh, but Dask blames a worker's death on
    all tasks that it had.
    """

    def __init__(self, address: str, compute: Compute = run_trial) -> None:
        """Prepare to use the scheduler at `address`, such as tcp://127.0.0.1:8786."""
        self._address = address
        self._compute = compute
        self._workers = 0

    @property
    def workers(self) -> int:
        """The most workers that the newest run had at a time."""
        return self._workers

    def run(self, tasks: Iterable[TrialTask], reporter: Reporter) -> Iterator[tuple[int, TrialResult]]:
        """Yield each task's place and its result as they are finished; see `Engine.run`.

        Raises:
            InputError: there is no scheduler at the address, or one that does not fit.
        """
        self._workers = 0
        client = _connected(self._address)
        flight = _Flight(client, self._compute)
        try:
            yield from self._run(flight, enumerate(tasks), reporter)
        finally:
            flight.cancel()

    def _run(
        self, flight: _Flight, tasks: Iterator[tuple[int, TrialTask]], reporter: Reporter
    ) -> Iterator[tuple[int, TrialResult]]:
        count = _WorkerCount(flight.client, self._address, reporter)
        job = next(tasks, None)
        while job is not None or len(flight) or flight.suspects:
            reporter.raise_if_cancelled()
            n_workers = count.workers()
            self._workers = max(self._workers, n_workers)
            while job is not None and len(flight) < n_workers:
                flight.start(*job)
                job = next(tasks, None)
            if job is None and n_workers and not len(flight) and flight.suspects:
                flight.start_suspect()
            yield from flight.landed()
            time.sleep(_POLL_S)


class _Flight:
    """The tasks that the cluster has.

    Attributes:
        suspects: tasks that Dask gave up because workers died; it blames every task that a dying worker
            holds, so each of them is tried once more at the end, alone.
    """

    def __init__(self, client: Client, compute: Compute) -> None:
        self.client = client
        self._compute = compute
        self._futures: dict[Future, tuple[int, TrialTask]] = {}
        self.suspects: list[tuple[int, TrialTask]] = []
        self._convicted: set[int] = set()

    def __len__(self) -> int:
        return len(self._futures)

    def start(self, index: int, task: TrialTask) -> None:
        """Hand a task over; as bytes, which the scheduler passes on without looking into them."""
        future = self.client.submit(
            compute_there,
            pickle.dumps((self._compute, task)),
            _decisive_versions(),
            key=f"trial-{index}-{uuid.uuid4().hex}",
            pure=False,
        )
        self._futures[future] = index, task

    def landed(self) -> Iterator[tuple[int, TrialResult]]:
        """Yield what is finished."""
        for future in [one for one in self._futures if one.done()]:
            index, task = self._futures.pop(future)
            if index not in self._convicted and _was_killed(future):
                self.suspects.append((index, task))
                continue
            yield index, _result(future, task)

    def start_suspect(self) -> None:
        """Try a suspect once more, with no other task around; if its workers die again, it is what kills."""
        index, task = self.suspects.pop(0)
        self._convicted.add(index)
        self.start(index, task)

    def cancel(self) -> None:
        """Let go of the tasks that are not finished, and of the cluster."""
        with suppress(Exception):  # the scheduler may be what has gone
            if self.client.status == "running":
                self.client.cancel(list(self._futures))
            self.client.close(timeout=_CONNECT_S)


class _WorkerCount:
    """How many workers there are; the scheduler is asked now and then."""

    def __init__(self, client: Client, address: str, reporter: Reporter) -> None:
        self._client, self._address, self._reporter = client, address, reporter
        self._n_workers = 0
        self._counted_s = -float("inf")
        self._empty_since_s: float | None = None
        self._is_warned = False

    def workers(self) -> int:
        """Return how many workers there are.

        Raises:
            WorkerError: the scheduler has gone.
        """
        if self._client.status != "running":
            raise _lost(self._address)
        now_s = time.monotonic()
        if now_s - self._counted_s > _COUNT_EVERY_S:
            self._counted_s = now_s
            self._n_workers = self._count()
            self._warn(now_s)
        return self._n_workers

    def _count(self) -> int:
        try:
            return len(self._client.nthreads())
        except (OSError, ValueError, RuntimeError) as error:
            raise _lost(self._address) from error

    def _warn(self, now_s: float) -> None:
        if self._n_workers:
            self._empty_since_s = None
            return
        self._empty_since_s = self._empty_since_s or now_s
        if now_s - self._empty_since_s > _WARN_AFTER_S and not self._is_warned:
            self._is_warned = True
            self._reporter.warn(
                f"The scheduler at {self._address} has no worker, so this waits for one; "
                f"'dask worker {self._address} --nthreads 1' starts one."
            )


class UnfitWorkerError(Exception):
    """A worker that would compute something else, or could not compute at all."""


def compute_there(work: bytes, versions: dict[str, str]) -> TrialResult:
    """Compute a task in a worker of the cluster.

    Args:
        work: the pickled function and its task.
        versions: of what decides the result, where the evaluation was started.

    Raises:
        UnfitWorkerError: this worker must not compute it.
    """
    from distributed import get_worker

    ours = _decisive_versions()
    if ours != versions:
        differ = ", ".join(f"{name} {ours[name]} there, {versions[name]} here" for name in ours)
        raise UnfitWorkerError(f"has other versions ({differ}); install the same ones")
    if get_worker().state.nthreads > 1:
        raise UnfitWorkerError(
            "computes in several threads, which the physics cannot; start it with --nthreads 1"
        )
    compute, task = pickle.loads(work)
    with _ALONE, quiet(1):
        result: TrialResult = compute(task)
    return result


def _decisive_versions() -> dict[str, str]:
    return {name: version for name, version in program_versions().items() if name != "python"}


def _was_killed(future: Future) -> bool:
    from distributed import KilledWorker

    return future.status == "error" and isinstance(future.exception(), KilledWorker)


def _result(future: Future, task: TrialTask) -> TrialResult:
    from distributed import KilledWorker

    try:
        result: TrialResult = future.result()
    except KilledWorker as error:
        return given_up(task, death_sentence(error.allowed_failures + 1))
    except UnfitWorkerError as error:
        raise WorkerError(f"A worker of the cluster {error}.", Remedy.RUN_AGAIN) from error
    except ImportError as error:
        raise WorkerError(
            f"The cluster cannot run the program ({error}); install it, in the same version, on its machines."
        ) from error
    except CancelledError as error:
        raise _lost(future.client.scheduler.address) from error
    except Exception as error:  # one object must not end the run of all others
        return given_up(task, fault_sentence(error))
    return result


def _lost(address: str) -> WorkerError:
    return WorkerError(
        f"The scheduler at {excerpt(address)} has gone; start it again. What is done is kept.",
        Remedy.CONTINUE,
    )


def _connected(address: str) -> Client:
    """Connect to a scheduler that runs the same versions of Dask."""
    import dask
    from distributed import Client

    dask.config.set({"distributed.admin.large-graph-warning-threshold": _LARGEST_MESH})
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters is said in our words
    try:
        asyncio.run(asyncio.wait_for(_greet(address), 2 * _CONNECT_S))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of other versions: see below
            client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError, ImportError, asyncio.TimeoutError) as error:
        raise InputError(
            f"There is no Dask scheduler at {excerpt(address)} that answers ({_first_line(error)}).",
            Remedy.START_CLUSTER,
        ) from error
    try:
        _check_versions(client, address)
    except BaseException:
        client.close(timeout=_CONNECT_S)
        raise
    return client


async def _greet(address: str) -> None:
    """Find out that a scheduler answers: a client waits without end for what is none."""
    from distributed import Security
    from distributed.comm import connect

    comm = await connect(address, timeout=_CONNECT_S, **Security().get_connection_args("client"))
    await comm.close()


def _check_versions(client: Client, address: str) -> None:
    said: Any = client.get_versions()
    ours = said["client"]["packages"]
    for place, theirs in (("scheduler", said["scheduler"]), *said["workers"].items()):
        for name in ("dask", "distributed"):
            version = theirs["packages"].get(name)
            if version != ours[name]:
                raise InputError(
                    f"The cluster at {address} has other versions ({name} {version} at {place}, {ours[name]} "
                    "here); install the same ones everywhere."
                )


def _first_line(error: BaseException) -> str:
    return excerpt((str(error) or type(error).__name__).splitlines()[0].rstrip("."))


@contextmanager
def _replenished(cluster: LocalCluster, n_workers: int) -> Iterator[None]:
    """Start workers anew that are gone for good: Dask keeps the place of one whose start failed or hung."""
    from distributed.core import Status

    is_over = threading.Event()

    def replenish() -> None:
        for name, nanny in list(cluster.workers.items()):
            if nanny.status in (Status.failed, Status.closed):
                del cluster.workers[name]
        cluster.scale(n_workers)

    def watch() -> None:
        while not is_over.wait(_REPLENISH_S):
            cluster.loop.add_callback(replenish)

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def _started(n_workers: int, port: int) -> LocalCluster:
    import dask
    from distributed import LocalCluster

    dask.config.set(
        {
            "distributed.nanny.pre-spawn-environ": THREADS,
            "distributed.scheduler.allowed-failures": MAX_DEATHS - 1,
            "distributed.deploy.lost-worker-timeout": f"{_START_S}s",
        }
    )
    try:
        return LocalCluster(
            n_workers=n_workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            scheduler_port=port,
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            memory_limit=0,
            death_timeout=_START_S,
            silence_logs=logging.CRITICAL,
        )
    except (OSError, RuntimeError) as error:
        raise InputError(
            f"The cluster cannot be started at port {port} ({_cause(error)}); choose another port, "
            "or 0 for any."
        ) from error


def _cause(error: BaseException) -> str:
    """The system's words at the end of a chain of errors."""
    while error.__cause__ is not None:
        error = error.__cause__
    return getattr(error, "strerror", None) or str(error)
