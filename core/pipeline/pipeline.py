"""The way of the data through a session: every stage is loaded when fresh and run when stale."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import Any

from core.collision import CollisionModel
from core.errors import Remedy, SessionError, StageError
from core.files import read_json, reading, write_json
from core.formats.tables import Warnings
from core.imagination.amount.reasoning import is_one_cup_asked_for
from core.imagination.cup_runs import CupRuns
from core.imagination.imagination import Imagination
from core.imagination.kept_runs import KeptRuns
from core.imagination.rendering.evidence import Evidence
from core.mesh import TriangleMesh
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourMotions
from core.parameters import Parameters, load_preset
from core.pipeline.freshness import Freshness, freshness, is_fresh, motion_settings, source_of
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.news import StageDone
from core.pipeline.report_content import gather
from core.pipeline.running import (
    RUNS,
    Given,
    Result,
    Tools,
    result_of,
    run_in_workers,
    run_stage,
    with_n_pour,
)
from core.pipeline.session_view import IMAGINED, SessionView
from core.progress import Reporter
from core.quality.measures import ScanQuality
from core.reconstruction.colors import ModelColors
from core.reconstruction.result import Reconstruction
from core.report import write_report
from core.scan import Scan, read_scan, write_scan
from core.session import Session, StageRecord
from core.stages import GIVEN, MESH, SCAN, STAGE_NAMES, stage, stages_before, stages_that_end_with
from core.workers import WorkerPool

WARNINGS_FILE = "warnings.json"


class _Keeping(Reporter):
    """Passes everything on and keeps the warnings of the running stage for its folder."""

    def __init__(self, face: Reporter) -> None:
        super().__init__()
        self._face = face
        self._warnings: list[str] = []

    def progress(self, stage: str, done: float, total: float) -> None:
        self._face.progress(stage, done, total)

    def warn(self, sentence: str) -> None:
        self._warnings.append(sentence)
        self._face.warn(sentence)

    def tell(self, news: object) -> None:
        self._face.tell(news)

    def raise_if_cancelled(self) -> None:
        self._face.raise_if_cancelled()

    def take_warnings(self) -> list[str]:
        """Return the sentences since the last call."""
        taken, self._warnings = self._warnings, []
        return taken


class Pipeline:
    """Runs the stages of one session with one set of parameters; the session must be held (`with session`).

    Every stage is loaded when it is fresh, and run, after those before it, when it is stale.
    """

    def __init__(
        self,
        session: Session,
        parameters: Parameters,
        pool: WorkerPool,
        reporter: Reporter,
        preset: str = "default",
        base: Parameters | None = None,
        kept: KeptRuns | None = None,
    ) -> None:
        """`preset` names what the parameters started from; the report shows the difference.

        Args:
            session: to work on.
            parameters: of all stages.
            pool: runs what is computed.
            reporter: shows progress.
            preset: its name or file.
            base: its parameters; none: they are read by its name.
            kept: runs of the cup from earlier sessions; none: all are made anew.
        """
        self.session = session
        self.parameters = parameters
        self.reporter = _Keeping(reporter)
        self.pool = pool
        self._preset = preset
        self._base = base
        self._tools = Tools(pool, self.reporter, cup_runs=CupRuns(kept))
        self._known: dict[str, tuple[str, Any]] = {}

    def import_scan(self, folder: Path) -> Scan:
        """Take over a scan in the authors' layout.

        Raises:
            InputError: the scan cannot be used as it is.
        """
        return self.keep_scan(read_scan(folder, self.reporter), {"source": str(folder.resolve())})

    def keep_scan(self, scan: Scan, origin: dict[str, Any]) -> Scan:
        """Make `scan` the session's scan; `origin` says where it is from."""
        self.keep_written_scan(lambda folder: write_scan(scan, folder), origin)
        return scan

    def keep_written_scan(self, write: Callable[[Path], None], origin: dict[str, Any]) -> None:
        """Make what `write` puts into an empty folder, in the authors' layout, the session's scan.

        Args:
            write: called with the folder.
            origin: where the scan is from, as plain JSON; `table_height_m` in it is the cell's.

        Raises:
            SessionError: the session holds a mesh, or cannot be written.
        """
        if self.session.record(MESH) is not None:
            raise SessionError(f"The session {self.session.path} holds a mesh.", Remedy.NEW_SESSION)
        with self.session.writing(SCAN, inputs={}, parameters=origin) as folder:
            write(folder)
            self._keep_warnings(folder)

    def import_mesh(self, path: Path) -> TriangleMesh:
        """Take over a mesh instead of a scan; a file of several convex parts keeps them.

        Raises:
            InputError: the mesh cannot be used as it is.
            SessionError: the session holds a scan.
        """
        if self.session.record(SCAN) is not None:
            raise SessionError(f"The session {self.session.path} holds a scan.", Remedy.NEW_SESSION)
        given = GivenMesh.read(path, self.reporter)
        with self.session.writing(MESH, inputs={}, parameters={"source": str(path.resolve())}) as folder:
            given.save(folder)
            self._keep_warnings(folder)
        return given.mesh

    def reconstruction(self) -> Reconstruction:
        """Fuse the scan into a mesh (Sec. IV-A)."""
        found: Reconstruction = self.result("reconstruction")
        return found

    def quality(self) -> ScanQuality:
        """Judge the scan: what it did not see, and how well its views agree."""
        found: ScanQuality = self.result("quality")
        return found

    def colors(self) -> ModelColors:
        """Colour the reconstructed surface by the scan's images."""
        found: ModelColors = self.result("colors")
        return found

    def surface(self) -> TriangleMesh:
        """Return the object's mesh, reconstructed or imported."""
        mesh: TriangleMesh = self.result(source_of(self.session)).mesh
        return mesh

    def collision(self) -> CollisionModel:
        """Make the surface a body for the physics (Sec. IV-C)."""
        found: CollisionModel = self.result("collision")
        return found

    def imagination(self) -> Imagination:
        """Imagine open containability and the pours (Sec. III-A, III-B)."""
        self._prepare_cup_runs()
        drop, judgement, planned, grid, tries = (self.result(name) for name in IMAGINED)
        retention = self.result("retention")
        seconds = {name: self._record(name).seconds for name in IMAGINED}
        pouring_s = seconds["pouring"] + seconds["risk"]
        return Imagination.of(
            drop,
            judgement,
            planned,
            grid,
            tries,
            retention,
            cup=self.parameters.pouring.cup,
            containability_s=sum(seconds.values()) - pouring_s,
            pouring_s=pouring_s,
        )

    def poured_parameters(self) -> Parameters:
        """Return the parameters with the N_pour that the pours were imagined with."""
        grid = self.imagination().grid
        return self.parameters if grid is None else with_n_pour(self.parameters, grid.n_pour)

    def motion(self, cell: PourCell, described: dict[str, Any]) -> PourMotions | None:
        """Judge which of the imagined pours the arm of a cell can make, and choose among them.

        Args:
            cell: the arm and what stands around it.
            described: the same as plain JSON, for the record.

        Returns:
            What was found; none if there is no pour to make.

        Raises:
            MotionError: the arm cannot even take the cup; the sentence says why.
        """
        if self.imagination().choice is None:
            return None
        self._tools.cell = cell
        self._bring_up_to_date("motion", motion_settings(described, self.parameters))
        found: PourMotions = self._loaded("motion")
        return found

    def evidence(self, early: Path | None = None) -> Evidence:
        """Render stills and films of what was imagined; `early` takes each still as soon as it is drawn."""
        self._prepare_cup_runs()
        self._tools.early = early
        found: Evidence = self.result("evidence")
        return found

    def report(self) -> Path:
        """Write the session's report and return its path."""
        evidence = self.evidence()
        is_scan = source_of(self.session) != MESH
        if is_scan:
            self.colors()
        content = gather(
            self.session,
            (self._preset, load_preset(self._preset) if self._base is None else self._base),
            self.parameters,
            self.surface(),
            self.reconstruction() if is_scan else None,
            self.quality() if is_scan else None,
            self.imagination(),
            evidence,
            SessionView(self.session).motions,
            self.warnings(),
        )
        path = self.session.path / "report.html"
        write_report(content, path)
        return path

    def warnings(self) -> list[str]:
        """Return what the stages wanted the user to know."""
        found: list[str] = []
        for name in STAGE_NAMES:
            path = self.session.path / name / WARNINGS_FILE
            if not path.exists():
                continue
            try:
                found += read_json(path, Warnings)["warnings"]
            except SessionError as error:
                found.append(f"{error} What the stage '{name}' wanted to be known is missing here.")
        return found

    def result(self, name: str) -> Any:
        """Return a stage's result, brought up to date.

        Raises:
            SessionError: the session holds neither scan nor mesh, or cannot be read or written.
            StageError: a stage could not reach a result.
            Cancelled: somebody asked to stop; what was finished is kept.
        """
        for each in stages_before(name, source_of(self.session)):
            if each not in GIVEN:
                self._bring_up_to_date(each, stage(each).settings(self.parameters))
        return self._loaded(name)

    def side_by_side(self, *names: str) -> None:
        """Bring stages up to date that are tasks and nothing else, and need nothing of each other.

        Raises:
            SessionError, StageError, Cancelled: see `result`.
        """
        for name in names:
            for each in stages_before(name, source_of(self.session)):
                if each not in (*GIVEN, *names):
                    self._bring_up_to_date(each, stage(each).settings(self.parameters))
        stale = [name for name in names if not self._is_fresh(name, stage(name).settings(self.parameters))]
        if not stale:
            return
        given = {name: self._given(name) for name in stale}
        started = perf_counter()
        done = run_in_workers(given, self.pool, self.reporter)
        seconds = perf_counter() - started
        for name, of_one in zip(stale, done, strict=True):
            settings = stage(name).settings(self.parameters)
            self._keep(name, self._digests(name), settings, seconds, result_of(name, given[name], of_one))

    def _bring_up_to_date(self, name: str, settings: dict[str, Any]) -> None:
        """Run a stage if it is stale; those that it is made from are fresh."""
        if not self._is_fresh(name, settings):
            self._run(name, self._digests(name), settings)

    def _is_fresh(self, name: str, settings: dict[str, Any]) -> bool:
        record = self.session.record(name)
        return record is not None and is_fresh(self.session, record, self._digests(name), settings)

    def _digests(self, name: str) -> dict[str, str]:
        """Those of the stages that it is made from."""
        inputs = stage(name).inputs_of(source_of(self.session))
        return {before: self._record(before).digest for before in inputs}

    def _run(self, name: str, digests: dict[str, str], settings: dict[str, Any]) -> None:
        for later in stages_that_end_with(name):
            RUNS[later].ahead(self._given(later))
        started = perf_counter()
        result = run_stage(name, self._given(name))
        self._keep(name, digests, settings, perf_counter() - started, result)

    def _keep(
        self,
        name: str,
        digests: dict[str, str],
        settings: dict[str, Any],
        seconds: float,
        result: Result | None,
    ) -> None:
        with self.session.writing(name, inputs=digests, parameters=settings, seconds=seconds) as folder:
            if result is not None:
                result.save(folder)
            self._keep_warnings(folder)
        self._known[name] = self._record(name).digest, result
        self.reporter.tell(StageDone(self.session.path, name))

    def _loaded(self, name: str) -> Any:
        """Return the result that a stage's folder holds; what was just computed or read is not read again.

        What was damaged since it was computed is computed again; what was given cannot be.
        """
        record = self._record(name)
        if name not in self._known or self._known[name][0] != record.digest:
            try:
                self._known[name] = record.digest, self._read(name, record)
            except SessionError as error:
                if name in GIVEN:
                    raise
                self.reporter.warn(f"{error} It is made anew.")
                self._run(name, record.inputs, record.parameters)
        return self._known[name][1]

    def _read(self, name: str, record: StageRecord) -> Any:
        folder = self.session.folder(name)
        if name not in GIVEN and not record.is_unchanged(folder):
            raise SessionError(f"The files in {folder} are not those that were written.")
        with reading(folder):
            return RUNS[name].load(folder)

    def _given(self, name: str) -> Given:
        part = stage(name).part(self.parameters)
        scan = self.session.record(SCAN)
        return Given(
            part,
            self._loaded,
            source_of(self.session),
            self.session.path,
            scan.parameters if scan else {},
            self._tools,
            self._tools.context(part),
        )

    def _prepare_cup_runs(self) -> None:
        """The cup's runs need nothing of the object: they shall fill the core that the drop leaves idle."""
        stages = freshness(self.session, self.parameters)
        if stages["containability"] is Freshness.FRESH:
            return
        with suppress(StageError):  # what the cup cannot hold the amount says, after the drop had its say
            if not is_one_cup_asked_for(self.parameters):
                return
            part = stage("pouring").part(self.parameters)
            context = self._tools.context(with_n_pour(part, self.parameters.pouring.n_pour))
            self._tools.cup_runs.prepare(context)

    def _record(self, name: str) -> StageRecord:
        record = self.session.record(name)
        if record is None:
            raise SessionError(f"The session {self.session.path} holds no '{name}' yet.", Remedy.IMPORT_SCAN)
        return record

    def _keep_warnings(self, folder: Path) -> None:
        warnings = self.reporter.take_warnings()
        if warnings:
            write_json(folder / WARNINGS_FILE, {"warnings": warnings})
