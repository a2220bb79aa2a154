"""The way of the data through a session: every stage is loaded when fresh and run when stale."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, Protocol, TypeVar

import numpy as np

from core.collision import CollisionModel, from_parts
from core.errors import SessionError
from core.files import read_json, write_json
from core.geometry import BoolArray
from core.imagination.choice import choose_pour
from core.imagination.cup_runs import CupRuns
from core.imagination.imagine import Imagination, imagine, imagine_grid_risk
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.render import render_evidence
from core.imagination.rendering.shapes import cup_surface
from core.imagination.results import PourGrid
from core.imagination.risk.results import PourRisk
from core.imagination.risk.scan_error import with_scan_error
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh, read_mesh_parts
from core.mesh_topology import is_convex, join
from core.motion.pour.cell import PourCell
from core.motion.pour.choosing import PourMotions, feasible_pours
from core.motion.pour.planning import judge_pours
from core.parameters import Parameters, load_preset
from core.pipeline import kept_imagination
from core.pipeline.jobs import collision_job, quality_job, reconstruction_job
from core.pipeline.needs import source_of, stage_needs
from core.pipeline.report_content import gather
from core.ply import read_ply, write_ply
from core.progress import Reporter
from core.quality.measures import ScanQuality
from core.reconstruction.result import Reconstruction
from core.report import write_report
from core.scan import Scan, read_scan, write_scan
from core.session import Session
from core.workers import Task, WorkerPool

WARNINGS_FILE = "warnings.json"


class _Result(Protocol):
    def save(self, folder: Path) -> None: ...


_R = TypeVar("_R", bound=_Result)


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

    def raise_if_cancelled(self) -> None:
        self._face.raise_if_cancelled()

    def take_warnings(self) -> list[str]:
        """Return the sentences since the last call."""
        taken, self._warnings = self._warnings, []
        return taken


class Pipeline:
    """Runs the stages of one session with one set of parameters; the session must be held (`with session`).

    Every method returns a stage's result. It runs what is stale before it, and nothing that is fresh.
    """

    def __init__(
        self,
        session: Session,
        parameters: Parameters,
        pool: WorkerPool,
        reporter: Reporter,
        preset: str = "default",
    ) -> None:
        """`preset` is what the parameters started from; the report shows the difference."""
        self.session = session
        self.parameters = parameters
        self.reporter = _Keeping(reporter)
        self.pool = pool
        self._preset = preset

    def import_scan(self, folder: Path) -> Scan:
        """Take over a scan in the authors' layout.

        Raises:
            InputError: the scan cannot be used as it is.
        """
        return self.keep_scan(read_scan(folder, self.reporter), {"source": str(folder.resolve())})

    def keep_scan(self, scan: Scan, origin: dict[str, Any]) -> Scan:
        """Make `scan` the session's scan; `origin` says where it is from."""
        self.keep_written_scan(lambda stage: write_scan(scan, stage), origin)
        return scan

    def keep_written_scan(self, write: Callable[[Path], None], origin: dict[str, Any]) -> None:
        """Make what `write` puts into an empty folder, in the authors' layout, the session's scan.

        Args:
            write: called with the folder.
            origin: where the scan is from, as plain JSON; `table_height_m` in it is the cell's.

        Raises:
            SessionError: the session holds a mesh, or cannot be written.
        """
        if self.session.record("mesh") is not None:
            raise SessionError(
                f"The session {self.session.path} holds a mesh; give another --session for the scan."
            )
        with self.session.writing("scan", inputs={}, parameters=origin) as stage:
            write(stage)
            self._keep_warnings(stage)

    def import_mesh(self, path: Path) -> TriangleMesh:
        """Take over a mesh instead of a scan; a file of several convex parts keeps them.

        Raises:
            InputError: the mesh cannot be used as it is.
            SessionError: the session holds a scan.
        """
        if self.session.record("scan") is not None:
            raise SessionError(
                f"The session {self.session.path} holds a scan; give another --session for the mesh {path}."
            )
        parts = read_mesh_parts(path, self.reporter)
        are_convex = len(parts) > 1 and all(map(is_convex, parts))
        mesh = join(parts) if are_convex else read_mesh(path, self.reporter)
        with self.session.writing("mesh", inputs={}, parameters={"source": str(path.resolve())}) as stage:
            write_ply(stage / "mesh.ply", mesh)
            if are_convex:
                from_parts(parts).save(stage)
            self._keep_warnings(stage)
        return mesh

    def reconstruction(self) -> Reconstruction:
        """Fuse the scan into a mesh (Sec. IV-A)."""
        settings = self.parameters.reconstruction
        job = Task(reconstruction_job, (self.session.path / "scan", settings))

        def run() -> Reconstruction:
            result: Reconstruction = self._in_worker(job, "reconstruction")
            return result

        return self._stage("reconstruction", Reconstruction.load, run)

    def quality(self) -> ScanQuality:
        """Judge the scan: what it did not see, and how well its views agree."""
        self.reconstruction()
        record = self.session.record("scan")
        table_height_m = record.parameters.get("table_height_m") if record else None
        settings = self.parameters.reconstruction
        folders = self.session.path / "scan", self.session.path / "reconstruction"
        job = Task(quality_job, (*folders, settings, table_height_m))

        def run() -> ScanQuality:
            result: ScanQuality = self._in_worker(job, "quality")
            return result

        return self._stage("quality", ScanQuality.load, run)

    def surface(self) -> TriangleMesh:
        """Return the object's mesh, reconstructed or imported."""
        if self.session.record("mesh") is not None:
            return read_ply(self.session.folder("mesh") / "mesh.ply")
        return self.reconstruction().mesh

    def collision(self) -> CollisionModel:
        """Make the surface a body for the physics (Sec. IV-C)."""
        settings = self.parameters.collision
        surface = self.surface()

        def run() -> CollisionModel:
            given = self._given_parts()
            if given is not None and settings.method != "exact":
                return given
            model: CollisionModel = self._in_worker(Task(collision_job, (surface, settings)), "collision")
            return model

        return self._stage("collision", CollisionModel.load, run)

    def imagination(self) -> Imagination:
        """Imagine open containability and the pours (Sec. III-A, III-B)."""
        model = self.collision()
        needs = stage_needs(self.parameters, self._source())["containability"]  # the pouring's are the same
        settings = needs.settings
        inputs = self._digests(needs.inputs)
        if all(self.session.is_fresh(stage, inputs, settings) for stage in ("containability", "pouring")):
            return self._load_imagination()
        result = imagine(model, self._with_scan_error(self.parameters), self.pool, self.reporter)
        with self.session.writing(
            "containability", inputs=inputs, parameters=settings, seconds=result.containability_s
        ) as stage:
            kept_imagination.save_containability(result, stage)
        with self.session.writing(
            "pouring", inputs=inputs, parameters=settings, seconds=result.pouring_s
        ) as stage:
            kept_imagination.save_pouring(result, stage)
        return result

    def poured_parameters(self) -> Parameters:
        """Return the parameters with the N_pour that the pours were imagined with."""
        grid = self.imagination().grid
        if grid is None:
            return self.parameters
        pouring = self.parameters.pouring.model_copy(update={"n_pour": grid.n_pour})
        return self.parameters.model_copy(update={"pouring": pouring})

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
        imagination = self.imagination()
        grid, free_choice = imagination.grid, imagination.choice
        if grid is None or free_choice is None:
            return None

        def run() -> PourMotions:
            pouring = self.parameters.pouring
            pours = judge_pours(
                cell,
                imagination.containability.aabb_m,
                grid.theta_rad,
                grid.pivot_m,
                pouring,
                np.array(cell.home_rad),
                self.pool,
                self.reporter,
            )
            feasible = feasible_pours(pours, grid)
            if feasible[free_choice.i, free_choice.j]:
                return PourMotions(pours, free_choice, free_choice, None)
            risk = self._risk_among(feasible, grid, imagination.risk)
            return PourMotions(pours, choose_pour(grid, pouring.cup, feasible, risk), free_choice, risk)

        return self._fresh("motion", ("containability", "pouring"), described, PourMotions.load, run)

    def evidence(self, early: Path | None = None) -> Evidence:
        """Render stills and films of what was imagined; `early` takes each still as soon as it is drawn."""
        imagination = self.imagination()

        def run() -> Evidence:
            return render_evidence(
                self.surface(),
                cup_surface(self.parameters.pouring.cup),
                self.poured_parameters(),
                imagination.containability,
                imagination.grid,
                imagination.choice,
                self.pool,
                self.reporter,
                early,
            )

        return self._stage("evidence", Evidence.load, run)

    def report(self) -> Path:
        """Write the session's report and return its path."""
        evidence = self.evidence()
        is_scan = self._source() == "reconstruction"
        content = gather(
            self.session,
            (self._preset, load_preset(self._preset)),
            self.parameters,
            self.surface(),
            self.reconstruction() if is_scan else None,
            self.quality() if is_scan else None,
            self.imagination(),
            evidence,
            self._known_motions(),
            self.warnings(),
        )
        path = self.session.path / "report.html"
        write_report(content, path)
        return path

    def _risk_among(self, feasible: BoolArray, grid: PourGrid, known: PourRisk | None) -> PourRisk | None:
        """What is known of the risk, with further tries of pours that the arm can make until one is sure."""
        parameters = self._with_scan_error(self.poured_parameters())
        return imagine_grid_risk(
            self.collision(),
            grid,
            CupRuns(parameters),
            parameters,
            self.pool,
            self.reporter,
            known,
            feasible,
        )

    def _with_scan_error(self, parameters: Parameters) -> Parameters:
        """The parameters as this scan's poses want them; those of a mesh as they are."""
        if self._source() == "mesh":
            return parameters
        health = self.reconstruction().pose_health
        return with_scan_error(parameters, health.sd_height_m, len(health.views))

    def _known_motions(self) -> PourMotions | None:
        """What was found for a cell's arm, if it belongs to these pours."""
        record = self.session.record("motion")
        if record is None or record.inputs != self._digests(("containability", "pouring")):
            return None
        return PourMotions.load(self.session.folder("motion"))

    def warnings(self) -> list[str]:
        """Return what the stages wanted the user to know."""
        found: list[str] = []
        for stage in ("scan", "mesh", "reconstruction", "collision"):
            path = self.session.path / stage / WARNINGS_FILE
            if path.is_file():
                found += read_json(path)["warnings"]
        return found

    def _stage(self, stage: str, load: Callable[[Path], _R], run: Callable[[], _R]) -> _R:
        """Load a stage that depends on the session and its parameters alone, or run it."""
        needs = stage_needs(self.parameters, self._source())[stage]
        return self._fresh(stage, needs.inputs, needs.settings, load, run)

    def _fresh(
        self,
        stage: str,
        inputs: tuple[str, ...],
        parameters: dict[str, Any],
        load: Callable[[Path], _R],
        run: Callable[[], _R],
    ) -> _R:
        """Load a stage's result, or run it and keep the result."""
        digests = self._digests(inputs)
        if self.session.is_fresh(stage, digests, parameters):
            return load(self.session.folder(stage))
        started = perf_counter()
        result = run()
        seconds = perf_counter() - started
        with self.session.writing(stage, inputs=digests, parameters=parameters, seconds=seconds) as folder:
            result.save(folder)
            self._keep_warnings(folder)
        return result

    def _in_worker(self, task: Task, label: str) -> Any:
        result, warnings = self.pool.run([task], label, self.reporter)[0]
        for sentence in warnings:
            self.reporter.warn(sentence)
        return result

    def _keep_warnings(self, folder: Path) -> None:
        warnings = self.reporter.take_warnings()
        if warnings:
            write_json(folder / WARNINGS_FILE, {"warnings": warnings})

    def _digests(self, stages: tuple[str, ...]) -> dict[str, str]:
        digests = {}
        for stage in stages:
            record = self.session.record(stage)
            if record is None:
                raise SessionError(
                    f"The session {self.session.path} holds no '{stage}' yet; "
                    "import a scan with 'poursight import FOLDER --session DIR' first."
                )
            digests[stage] = record.digest
        return digests

    def _source(self) -> str:
        return source_of(self.session)

    def _given_parts(self) -> CollisionModel | None:
        folder = self.session.path / "mesh"
        return CollisionModel.load(folder) if (folder / "collision.json").is_file() else None

    def _load_imagination(self) -> Imagination:
        records = [self.session.record(stage) for stage in ("containability", "pouring")]
        seconds = [record.seconds if record else 0.0 for record in records]
        folders = self.session.folder("containability"), self.session.folder("pouring")
        return kept_imagination.load(*folders, self.parameters.pouring.cup, *seconds)
