"""The stages of a session, for a host process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from app.jobs.face import JobFace
from app.jobs.messages import News
from app.jobs.render_news import PictureWatch
from app.jobs.service import Service
from app.remembered import remember_parameters
from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.progress import Reporter
from core.session import Session
from core.workers import Task, WorkerPool

if TYPE_CHECKING:
    from core.pipeline.pipeline import Pipeline
    from hardware.cell.settings import CellSettings


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
def working_on(task: SessionTask, pool: WorkerPool, reporter: Reporter) -> Iterator[Pipeline]:
    """Hold the session and remember the parameters.

    Raises:
        SessionError: it cannot be opened, or another program works on it.
    """
    from core.pipeline.pipeline import Pipeline

    with Session.create_or_open(task.folder) as session:
        remember_parameters(session.path, task.preset, task.parameters)
        yield Pipeline(session, task.parameters, pool, reporter, task.preset)


class SessionWork(Service):
    """Imports, reconstructs, imagines, judges motions, renders and reports; keeps its workers warm."""

    def __init__(self, tell: Callable[[News], None]) -> None:
        super().__init__(tell)
        self._pool = WorkerPool()

    def prepare(self) -> None:
        """Start the workers, and import what the first stage needs."""
        from core.imagination.imagine import WORKER_MODULE
        from core.pipeline import pipeline  # noqa: F401 - takes a second, which the first job then has not to wait

        self._pool.start(WORKER_MODULE)

    def close(self) -> None:
        """End the workers."""
        self._pool.close()

    def import_scan(self, face: JobFace, task: SessionTask, folder: Path) -> None:
        """Take over a scan in the authors' layout, and judge it."""
        with working_on(task, self._pool, face) as pipeline:
            pipeline.import_scan(folder)
            pipeline.quality()

    def import_mesh(self, face: JobFace, task: SessionTask, path: Path) -> None:
        """Take over a mesh instead of a scan."""
        with working_on(task, self._pool, face) as pipeline:
            pipeline.import_mesh(path)

    def reconstruct(self, face: JobFace, task: SessionTask) -> None:
        """Fuse the scan, judge it, and build the collision model."""
        with working_on(task, self._pool, face) as pipeline:
            if pipeline.session.record("scan") is not None:
                pipeline.quality()
            pipeline.collision()

    def imagine(self, face: JobFace, task: SessionTask) -> None:
        """Imagine containability and pours, with whatever is stale before."""
        with working_on(task, self._pool, face) as pipeline:
            if pipeline.session.record("scan") is not None:
                pipeline.quality()
            pipeline.imagination()

    def compare_meshes(self, face: JobFace, before: TriangleMesh, after: TriangleMesh) -> FloatArray:
        """Return how far each vertex of `after` lies off `before`, in metres, positive outside of it."""
        from core.reconstruction.difference import surface_difference_m

        task = Task(surface_difference_m, (before, after))
        difference: FloatArray = self._pool.run([task], "difference", face)[0]
        return difference

    def render(self, face: JobFace, task: SessionTask) -> None:
        """Render stills and films of what was imagined; each still is told as soon as it is drawn."""
        with TemporaryDirectory(prefix="poursight-", ignore_cleanup_errors=True) as folder:
            watch = PictureWatch(face, task.folder, Path(folder))
            with working_on(task, self._pool, watch) as pipeline:
                pipeline.evidence(Path(folder))

    def judge_motions(self, face: JobFace, task: SessionTask, cell: CellSettings) -> None:
        """Find out which of the imagined pours the cell's arm can make.

        Raises:
            StageError: there is no pour to make.
            MotionError: the arm cannot take the cup at all.
        """
        from app.pouring import prepare

        with working_on(task, self._pool, face) as pipeline:
            prepare(pipeline, cell)

    def report(self, face: JobFace, task: SessionTask) -> Path:
        """Write the session's report and return its path."""
        with working_on(task, self._pool, face) as pipeline:
            return pipeline.report()

    def simulate_outcome(self, face: JobFace, task: SessionTask, cell: CellSettings, run: Path) -> None:
        """Let physics tell what became of a simulated pour's candies, and keep it with the run."""
        from app.outcome import simulated_outcome
        from core.session.pour_runs import write_outcome

        with working_on(task, self._pool, face) as pipeline:
            write_outcome(run, simulated_outcome(pipeline, cell, run))
