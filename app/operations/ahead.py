"""Computing while an arm scans what the imagination will need of the cup, whatever the object is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING

from app.library.places import cup_runs_folder
from core.errors import PoursightError
from core.imagination.kept_runs import KeptRuns
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import WorkerPool

if TYPE_CHECKING:
    from core.imagination.risk.ahead import CupRunsAhead


def runs_ahead(parameters: Parameters, pool: WorkerPool, reporter: Reporter) -> CupRunsAhead:
    """Return what makes the runs, and keeps them for all sessions.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    from core.imagination.context import ImaginationContext
    from core.imagination.cup_runs import CupRuns
    from core.imagination.risk.ahead import CupRunsAhead

    runs = CupRuns(KeptRuns(cup_runs_folder()))
    return CupRunsAhead(ImaginationContext(parameters, pool, reporter), runs)


@contextmanager
def computing_ahead(parameters: Parameters, pool: WorkerPool) -> Iterator[None]:
    """Use a pool that is idle inside the block; after it, it is idle again, and ready to reconstruct."""
    from core.pipeline.jobs import JOBS_MODULE
    from core.pipeline.rehearsal import rehearse_in

    ended, reporter = Event(), Reporter()
    pool.start(JOBS_MODULE)

    def compute() -> None:
        try:
            rehearse_in(pool, reporter)
            ahead = runs_ahead(parameters, pool, reporter)
            while not ended.is_set() and ahead.make_some():
                pass
        except PoursightError:
            pass  # nobody asked for it; who does later is told

    thread = Thread(target=compute, name="ahead of the pours", daemon=True)
    thread.start()
    try:
        yield
    except BaseException:
        reporter.cancel()  # whoever stopped the scan does not wait for a run of the cup
        raise
    finally:
        ended.set()
        thread.join()
