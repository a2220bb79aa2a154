"""Computing while an arm scans what the imagination will need of the cup, whatever the object is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING

from app.library.places import cup_runs_folder
from core.errors import PoursightError
from core.imagination.kept_runs import KeptRuns
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import Task, WorkerPool

if TYPE_CHECKING:
    from core.imagination.risk.ahead import CupRunsAhead


_NEXT_VIEW_S = 0.2


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


class ViewsAhead:
    """Lets the workers of an idle pool read each view of a scan while the arm takes the next one."""

    def __init__(self, unfinished: Path, parameters: Parameters, pool: WorkerPool) -> None:
        """`unfinished` is the folder of the scan that is being made."""
        self._unfinished, self._parameters, self._pool = unfinished, parameters, pool
        self._n_read = 0

    def read(self, reporter: Reporter) -> None:
        """Read what has come since the last time; any worker may be the one that reconstructs.

        Raises:
            Cancelled: the reporter was asked to stop.
            WorkerError: a worker died.
        """
        from core.pipeline.jobs import views_ahead_job
        from core.scan.authors_layout import FRAMES_FOLDER
        from core.scan.view_files import ENDINGS

        n_views = len(list((self._unfinished / FRAMES_FOLDER).glob(f"*{ENDINGS[-1]}")))
        if n_views == self._n_read:
            return
        self._n_read = n_views
        task = Task(views_ahead_job, (self._unfinished, self._parameters.reconstruction))
        self._pool.run([task] * self._pool.workers, "views", reporter)


@contextmanager
def computing_ahead(parameters: Parameters, pool: WorkerPool, unfinished: Path) -> Iterator[None]:
    """Use a pool that is idle inside the block; after it, it is idle again, and ready to reconstruct.

    Args:
        parameters: that the scan will be imagined with.
        pool: the idle one.
        unfinished: folder of the scan that is made inside the block.
    """
    from core.pipeline.jobs import JOBS_MODULE
    from core.pipeline.rehearsal import rehearse_in

    ended, reporter = Event(), Reporter()
    pool.start(JOBS_MODULE)

    def compute() -> None:
        try:
            rehearse_in(pool, reporter)
            ahead, views = runs_ahead(parameters, pool, reporter), ViewsAhead(unfinished, parameters, pool)
            while not ended.is_set():
                views.read(reporter)
                if not ahead.make_some():
                    ended.wait(_NEXT_VIEW_S)
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
