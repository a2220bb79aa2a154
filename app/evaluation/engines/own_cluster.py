"""`poursight cluster`: a scheduler and workers on this machine, for trying the cluster out."""

from __future__ import annotations

import logging
import os
import signal
import threading
from types import FrameType
from typing import TYPE_CHECKING

from app.evaluation.engines.engine import MAX_DEATHS, THREADS
from core.errors import InputError

if TYPE_CHECKING:
    from distributed import LocalCluster


def serve_cluster(workers: int | None, port: int) -> None:
    """Serve on loopback until Ctrl-C or SIGTERM; the workers end with this process, however it ends.

    Args:
        workers: worker processes; by default one for each processor this process may use.
        port: of the scheduler; 0: any that is free.

    Raises:
        InputError: the port is taken.
    """
    stopped = threading.Event()

    def stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    n_workers = workers or len(os.sched_getaffinity(0))
    with _cluster(n_workers, port) as cluster:
        print(
            f"A scheduler with {n_workers} {'worker' if n_workers == 1 else 'workers'} listens at "
            f"{cluster.scheduler_address}. Ctrl-C ends it.\n"
            f"poursight evaluate OBJECTS --out DIR --scheduler {cluster.scheduler_address}",
            flush=True,
        )
        stopped.wait()


def _cluster(n_workers: int, port: int) -> LocalCluster:
    import dask
    from distributed import LocalCluster

    dask.config.set(
        {
            "distributed.nanny.pre-spawn-environ": THREADS,
            "distributed.scheduler.allowed-failures": MAX_DEATHS - 1,
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
            silence_logs=logging.CRITICAL,
        )
    except (OSError, RuntimeError) as error:
        raise InputError(
            f"The cluster cannot be started at port {port} ({_cause(error)}); give another --port, "
            "or 0 for any."
        ) from error


def _cause(error: BaseException) -> str:
    """The system's words at the end of a chain of errors."""
    while error.__cause__ is not None:
        error = error.__cause__
    return getattr(error, "strerror", None) or str(error)
