"""Working on a session: which one, with which parameters, and held against other programs meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.library.places import cup_runs_folder
from app.library.session_folder import preset_of, remember_parameters, remembered_parameters
from core.parameters import Parameters
from core.progress import Reporter
from core.scratch import remove_left
from core.session import Session
from core.workers import WorkerPool

if TYPE_CHECKING:
    from core.pipeline.pipeline import Pipeline


@dataclass(frozen=True)
class SessionTask:
    """Which session to work on, and with what.

    Attributes:
        folder: the session's; made if it is not there yet.
        parameters: of all stages.
        preset: what they started from, by name.
    """

    folder: Path
    parameters: Parameters
    preset: str


@contextmanager
def working_on(
    task: SessionTask, pool: WorkerPool, reporter: Reporter, is_existing: bool = False
) -> Iterator[Pipeline]:
    """Hold the session and remember the parameters; what a killed program left elsewhere is removed.

    Args:
        task: the session and its parameters.
        pool: runs what is computed.
        reporter: shows progress.
        is_existing: whether to refuse a folder that is no session yet.

    Raises:
        SessionError: it cannot be opened, or another program works on it.
    """
    from core.imagination.kept_runs import KeptRuns
    from core.pipeline.pipeline import Pipeline

    remove_left()
    with (Session.open if is_existing else Session.create_or_open)(task.folder) as session:
        remember_parameters(session.path, task.preset, task.parameters)
        preset, base = preset_of(session.path, task.preset)
        kept = KeptRuns(cup_runs_folder())
        yield Pipeline(session, task.parameters, pool, reporter, preset, base, kept)


def bring_report_up_to_date(session: Path, reporter: Reporter, workers: int | None = None) -> Path | None:
    """Rewrite a session's report if it is out of date; return its path if it was.

    It is written with the parameters that the session was made with, not with those being tried now.

    Raises:
        StageError: the session holds nothing to report.
    """
    from app.library.exchange import report_is_current

    if report_is_current(session):
        return None
    preset, parameters = remembered_parameters(session) or ("default", Parameters())
    task = SessionTask(session, parameters, preset)
    with WorkerPool(workers) as pool, working_on(task, pool, reporter, is_existing=True) as pipeline:
        return pipeline.report()
