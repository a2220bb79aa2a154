"""Small sessions, written by the classes that write real ones."""

from __future__ import annotations

import json
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from app.library.session_folder import remember_parameters
from core.imagination.amount.result import PlannedAmount
from core.imagination.judgement import Judgement
from core.imagination.recording import Recorder
from core.imagination.rendering.evidence import Evidence
from core.imagination.results import Drop, Footprint, PourChoice, PourGrid
from core.imagination.risk.tries import Tries
from core.mesh import TriangleMesh
from core.mesh_file import read_ply, write_ply
from core.motion.pour.feasibility import PourFeasibility, PourMotions
from core.parameters import apply_settings, load_preset
from core.reconstruction.colors import ModelColors
from core.session import Session
from core.session.pour_runs import Outcome, next_run_folder, write_outcome
from core.stages import stage

P = [[0.5, 1.0, 1.0], [0.25, 0.75, 1.0]]
REPORT = "<!DOCTYPE html><title>report</title><h1>A report</h1><p>of a session</p>"


class SessionMaker:
    """Writes sessions stage by stage into one folder."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def __call__(self, name: str, *, kept: int = 40, **settings: object) -> Path:
        """A scanned and imagined object; `kept` of 100 candies stayed."""
        folder = self.empty(name)
        with Session.open(folder) as session:
            self._scan(session, name)
            self._stage(session, "reconstruction", ("scan",), self._mesh)
            self._stage(session, "collision", ("reconstruction",), lambda _: None)
            self.imagine(session, kept)
            remember_parameters(folder, "default", apply_settings(load_preset("default"), settings))
        return folder

    def empty(self, name: str) -> Path:
        return Session.create_or_open(self.root / name).path

    def of_mesh(self, name: str, file: str) -> Path:
        folder = self.empty(name)
        with Session.open(folder) as session:
            self._stage(session, "mesh", (), self._mesh, {"source": f"/somewhere/{file}"})
        return folder

    def imagine(self, session: Session, kept: int) -> None:
        self.drop(session, kept)
        self._imagined(session, "amount", PlannedAmount(60, None).save)
        self._imagined(session, "pouring", pours().save if kept else lambda _: None)
        self._imagined(session, "risk", Tries(None, choice(0, 1) if kept else None).save)

    def drop(self, session: Session, kept: int) -> None:
        """The drop and the verdict, without the pours."""
        self._imagined(session, "containability", drop(kept).save)
        self._imagined(session, "judgement", Judgement(0.0).save)

    def judge(self, folder: Path, chosen: tuple[int, int]) -> None:
        """The arm can make all pours but one, and makes `chosen`."""
        feasible = tuple(
            PourFeasibility(i, j, (i, j) != (0, 1), "too far", 0.02, 2.0, 20.0)
            for i in (0, 1)
            for j in range(3)
        )
        motions = PourMotions(feasible, choice(*chosen), choice(0, 1), None)
        with Session.open(folder) as session:
            self._imagined(session, "motion", motions.save)

    def render(self, folder: Path) -> None:
        pictures = {"drop_6_end.png": png((640, 480), (200, 0, 0))}
        with Session.open(folder) as session:
            self._imagined(session, "evidence", Evidence(pictures, "EGL").save)

    def pour(
        self, folder: Path, spilled: int | None = None, *, done: bool = True, back_off: bool = False
    ) -> Path:
        run = next_run_folder(folder)
        run.mkdir(parents=True)
        events = [{"time": "2026-11-21T11:09:44+00:00", "kind": "confirmed", "is_back_off": back_off}]
        events += [{"kind": "done"} if done else {"kind": "stopped", "sentence": "The robot stopped."}]
        (run / "events.jsonl").write_text("".join(json.dumps(event) + "\n" for event in events))
        if spilled is not None:
            write_outcome(run, Outcome(60, spilled, "", is_simulated=False, facts={}))
        return run

    def photograph(self, folder: Path) -> None:
        with Session.open(folder) as session:
            mesh = read_ply(session.path / "reconstruction" / "mesh.ply")
            colors = ModelColors(np.full(mesh.vertices_m.shape, 90, dtype=np.uint8))
            self._stage(session, "colors", ("scan", "reconstruction"), colors.save)

    def report(self, folder: Path) -> Path:
        (folder / "report.html").write_text(REPORT)
        return folder / "report.html"

    def _scan(self, session: Session, name: str) -> None:
        def write(stage: Path) -> None:
            (stage / "rgbd").mkdir()
            for view in range(3):
                picture = png((64, 48), (0, 0, 60 * view))
                (stage / "rgbd" / f"frame-{view:06d}.color.png").write_bytes(picture)

        self._stage(session, "scan", (), write, {"cell": {"name": "simulated cell"}, "object": name})

    def _mesh(self, stage: Path) -> None:
        write_ply(stage / "mesh.ply", box_mesh())

    def _imagined(self, session: Session, name: str, write: Callable[[Path], object]) -> None:
        self._stage(session, name, stage(name).inputs_of("reconstruction"), write, {"seed": 0})

    def _stage(
        self,
        session: Session,
        name: str,
        inputs: tuple[str, ...],
        write: Callable[[Path], object],
        parameters: dict[str, object] | None = None,
    ) -> None:
        digests = {stage: session.record(stage).digest for stage in inputs}
        with session.writing(name, inputs=digests, parameters=parameters or {}, seconds=1.5) as stage:
            write(stage)


def drop(kept: int) -> Drop:
    positions = np.column_stack([np.linspace(0, 0.1, 100), np.linspace(0, 0.05, 100), np.full(100, 0.2)])
    retained = np.arange(100) < kept
    footprint = Footprint.of(positions[retained, :2], 0.1) if kept else None
    aabb_m = np.array([[0, 0, 0], [0.1, 0.1, 0.1]])
    return Drop(positions, retained, aabb_m, footprint, Recorder(100).recording())


def pours() -> PourGrid:
    n_in = np.round(np.array(P)[:, :, None] * 60).astype(np.int64)
    recordings = tuple(tuple(Recorder(60).recording() for _ in range(3)) for _ in P)
    theta, indent = np.array([0.0, np.pi]), np.array([0.01, 0.02, 0.03])
    return PourGrid(60, n_in, 60 - n_in, theta, indent, np.zeros((2, 3, 3)), recordings)


def choice(i: int, j: int) -> PourChoice:
    return PourChoice(i, j, 0.0, np.zeros(3), np.eye(4))


def box_mesh(height_m: float = 0.05) -> TriangleMesh:
    corners = np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.08) for z in (0, height_m)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return TriangleMesh(corners, np.array(faces, dtype=np.int64))


def png(size: tuple[int, int], color: tuple[int, int, int]) -> bytes:
    buffer = BytesIO()
    Image.new("RGB", size, color).save(buffer, "PNG")
    return buffer.getvalue()


@pytest.fixture
def library_root(tmp_path: Path) -> Path:
    return tmp_path / "sessions"


@pytest.fixture
def make_session(library_root: Path) -> SessionMaker:
    return SessionMaker(library_root)


@pytest.fixture
def box() -> Callable[[float], TriangleMesh]:
    return box_mesh


@pytest.fixture(scope="module")
def results() -> SimpleNamespace:
    """Makers of results for whoever writes no session."""
    return SimpleNamespace(drop=drop, pours=pours, choice=choice, box_mesh=box_mesh, png=png)
