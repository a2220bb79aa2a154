"""The stages of a session, for a host process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.jobs.messages import Event
from app.jobs.service import ForwardingReporter, JobReporter, Service
from app.library.session_folder import UNFINISHED_SCAN
from app.operations.session import SessionTask, working_on
from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.progress import Reporter
from core.scratch import ScratchFolder, remove_left
from core.workers import Task, WorkerPool

if TYPE_CHECKING:
    from app.operations.ahead import ViewsAhead
    from core.imagination.risk.ahead import CupRunsAhead
    from hardware.cell.settings import CellSettings


OF_SCAN = ("quality", "colors")
"""What is told of a scan and its model, and read by no other stage."""


@dataclass(frozen=True)
class PictureDrawn:
    """A picture can be looked at before the others are done.

    Attributes:
        session: the folder of the session it belongs to.
        path: of its file, called as in the evidence; it goes when the next pictures are drawn.
    """

    session: Path
    path: Path


@dataclass(frozen=True)
class ScanChecked:
    """What decides how to go on with a scan that was reconstructed.

    Attributes:
        verdict: of its quality: good, usable, or scan again.
        hidden_area_m2: of the inside that no view saw, where views ended.
    """

    verdict: str
    hidden_area_m2: float


class SessionWork(Service):
    """Imports, reconstructs, imagines, judges motions, renders and reports; keeps its workers warm."""

    def __init__(self, send: Callable[[Event], None]) -> None:
        super().__init__(send)
        self._pool = WorkerPool()
        self._ahead: CupRunsAhead | None = None
        self._views: ViewsAhead | None = None
        self._wanted_ahead: SessionTask | None = None
        self._has_new_view = False

    def prepare(self) -> None:
        """Start the workers, import what the first stage needs, and remove what a killed program left."""
        from core.imagination.imagination import WORKER_MODULE
        from core.pipeline import pipeline  # noqa: F401 - takes a second, so not in the first job
        from core.pipeline.jobs import JOBS_MODULE

        remove_left()
        self._pool.start(WORKER_MODULE, JOBS_MODULE)

    def close(self) -> None:
        """End the workers."""
        self._pool.close()

    def compute_ahead(self, task: SessionTask) -> None:
        """Use idle time for what a scan of this session will need after its last view; an order."""
        self._wanted_ahead = task

    def read_ahead(self) -> None:
        """A view has come to the scan that is being made; an order."""
        self._has_new_view = True

    def use_idle_time(self, reporter: Reporter) -> bool:
        """Rehearse what follows a scan, read its views, and make some of the cup's runs, if it is wanted."""
        from app.operations.ahead import ViewsAhead, runs_ahead
        from core.pipeline.rehearsal import rehearse_in

        wanted, self._wanted_ahead = self._wanted_ahead, None
        if wanted is not None:
            rehearse_in(self._pool, reporter)
            self._ahead = runs_ahead(wanted.parameters, self._pool, reporter)
            self._views = ViewsAhead(wanted.folder / UNFINISHED_SCAN, wanted.parameters, self._pool)
        has_new_view, self._has_new_view = self._has_new_view, False
        if has_new_view and self._views is not None:
            self._views.read(reporter)
        ahead, self._ahead = self._ahead, None
        if ahead is not None and ahead.make_some():
            self._ahead = ahead
        return self._ahead is not None

    def import_scan(self, reporter: JobReporter, task: SessionTask, folder: Path) -> None:
        """Take over a scan in the authors' layout, and judge it."""
        with working_on(task, self._pool, reporter) as pipeline:
            pipeline.import_scan(folder)
            pipeline.side_by_side(*OF_SCAN)

    def import_mesh(self, reporter: JobReporter, task: SessionTask, path: Path) -> None:
        """Take over a mesh instead of a scan."""
        with working_on(task, self._pool, reporter) as pipeline:
            pipeline.import_mesh(path)

    def reconstruct(self, reporter: JobReporter, task: SessionTask) -> ScanChecked | None:
        """Fuse the scan, judge it, and build the collision model; return what was judged, if it is a scan."""
        with working_on(task, self._pool, reporter) as pipeline:
            if pipeline.session.record("scan") is None:
                pipeline.collision()
                return None
            pipeline.side_by_side(*OF_SCAN, "collision")
            quality = pipeline.quality()
            return ScanChecked(quality.verdict, quality.cavity.area_m2)

    def imagine(self, reporter: JobReporter, task: SessionTask) -> None:
        """Imagine containability and pours, with whatever is stale before."""
        with working_on(task, self._pool, reporter) as pipeline:
            if pipeline.session.record("scan") is not None:
                pipeline.side_by_side(*OF_SCAN, "collision")
            pipeline.imagination()

    def compare_meshes(self, reporter: JobReporter, before: TriangleMesh, after: TriangleMesh) -> FloatArray:
        """Return how far each vertex of `after` lies off `before`, in metres, positive outside of it."""
        from core.mesh import surface_difference_m

        task = Task(surface_difference_m, (before, after))
        difference: FloatArray = self._pool.run([task], "difference", reporter)[0]
        return difference

    def render(self, reporter: JobReporter, task: SessionTask) -> None:
        """Render stills and films of what was imagined; each still is reported as soon as it is drawn."""
        with ScratchFolder() as folder:
            pictures = PictureReporter(reporter, task.folder, folder)
            with working_on(task, self._pool, pictures) as pipeline:
                pipeline.evidence(folder)

    def judge_motions(self, reporter: JobReporter, task: SessionTask, cell: CellSettings) -> None:
        """Find out which of the imagined pours the cell's arm can make.

        Raises:
            StageError: there is no pour to make.
            MotionError: the arm cannot take the cup at all.
        """
        from app.operations.pouring import prepare

        with working_on(task, self._pool, reporter) as pipeline:
            prepare(pipeline, cell)

    def report(self, reporter: JobReporter, task: SessionTask) -> Path:
        """Write the session's report and return its path."""
        with working_on(task, self._pool, reporter) as pipeline:
            return pipeline.report()

    def simulate_outcome(
        self, reporter: JobReporter, task: SessionTask, cell: CellSettings, run: Path
    ) -> None:
        """Simulate what became of a simulated pour's candies, and record it with the run."""
        from app.operations.outcome import simulated_outcome
        from core.session.pour_runs import write_outcome

        with working_on(task, self._pool, reporter) as pipeline:
            write_outcome(run, simulated_outcome(pipeline, cell, run))


class PictureReporter(ForwardingReporter):
    """Reports also the pictures that have come into a folder."""

    def __init__(self, reporter: JobReporter, session: Path, folder: Path) -> None:
        super().__init__(reporter)
        self._session = session
        self._folder = folder
        self._reported: set[Path] = set()

    def progress(self, stage: str, done: float, total: float) -> None:
        """Forward it; it comes often enough to look for pictures."""
        super().progress(stage, done, total)
        for path in sorted(set(self._folder.glob("*.png")) - self._reported):
            self._reported.add(path)
            self._reporter.publish(PictureDrawn(self._session, path))
