"""What the page shows of a session's pours, read in a thread. No Qt here."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.pages.photographed import in_colors
from app.gui.views.scene.occlusion import surface_points_m
from app.gui.views.scene.parts import PreparedMesh, prepare_mesh
from app.gui.views.scene.shapes import Shape, band_mesh
from app.operations.choosing import current_motions
from core.errors import SessionError
from core.geometry import BoolArray, FloatArray
from core.imagination.amount.result import Amount
from core.imagination.fill_line import fill_line
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recording
from core.imagination.rendering.replay import make_replay
from core.imagination.rendering.shapes import candy_mesh, cup_surface
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.result import PourRisk
from core.mesh import TriangleMesh
from core.mesh_file import read_ply
from core.motion.pour.feasibility import PourFeasibility, PourMotions
from core.parameters.imagination import PouringParameters
from core.pipeline.session_view import SessionView
from core.session.operator_choice import OperatorChoice, read_operator_choice
from core.session.record import StageRecord

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings


_N_CASTERS = 15_000
_BAND_M, _BAND_APART_M = 0.002, 0.0004


@dataclass(frozen=True)
class FillBand:
    """How high an amount fills the object, as a band on its walls.

    Attributes:
        band: the band.
        label_m: (3,) where it is named.
        n_candies: that fill it so high, laid level.
    """

    band: PreparedMesh
    label_m: FloatArray
    n_candies: int


@dataclass(frozen=True)
class ShownPours:
    """Everything about a session's pours.

    Attributes:
        folder: the session's.
        record: of the imagined pours.
        tries: record of the further tries and the choice; none in sessions of earlier versions.
        containability: the verdict before them.
        grid: none if the object is no open container.
        choice: what the imagination alone would choose; none without a grid.
        imagined_risk: of the pours, whether or not the arm can make them; none if no tries were made.
        paper_choice: what the paper's rule says; none without a grid.
        amount: how many candies to pour; none if it is not known what the object holds.
        pouring: parameters that the pours were imagined with.
        candy: what the physics took a candy for, about its centre.
        candy_extents_m: (3,) its edge lengths.
        ground_m: height of what the object stands on.
        body: the object.
        casters_m: (n, 3) points all over it, for its shadow.
        cup: in its own frame.
        fill_line: how high the amount fills the object; none where that is not known.
        is_in_cell: false for an imported mesh, which no arm can reach.
        motions: which ones the cell's arm can make; none if that is not known.
        operator: what a person chose; none if nobody did.
        problem: why it is not known what a person chose; empty if it is.
    """

    folder: Path
    record: StageRecord
    tries: StageRecord | None
    containability: Containability
    grid: PourGrid | None
    choice: PourChoice | None
    imagined_risk: PourRisk | None
    paper_choice: PourChoice | None
    amount: Amount | None
    pouring: PouringParameters
    candy: Shape
    candy_extents_m: FloatArray
    ground_m: float
    body: PreparedMesh
    casters_m: FloatArray
    cup: PreparedMesh
    fill_line: FillBand | None
    is_in_cell: bool
    motions: PourMotions | None = None
    operator: OperatorChoice | None = None
    problem: str = ""

    def is_of_same_run(self, other: ShownPours | None) -> bool:
        """Whether both show the same imagined pours."""
        return other is not None and (self.folder, self.record) == (other.folder, other.record)

    @property
    def risk(self) -> PourRisk | None:
        """All trials, including those among the pours that the arm can make, where they were checked."""
        known = None if self.motions is None else self.motions.risk
        return known or self.imagined_risk

    @property
    def program_choice(self) -> PourChoice | None:
        """What the program would pour: the choice among the pours that the arm can make, where checked."""
        return self.choice if self.motions is None else self.motions.choice

    @property
    def is_free_choice(self) -> bool:
        """Whether the program would pour what the imagination alone chose."""
        return self.motions is None or not self.motions.is_changed

    @property
    def chosen(self) -> tuple[int, int] | None:
        """(i, j) of the pour that will be made; none if there is none."""
        choice = self.operator or self.program_choice
        return None if choice is None else (choice.i, choice.j)

    def feasibility(self, i: int, j: int) -> PourFeasibility | None:
        """What was found of the arm for a pour; none if that is not known."""
        return None if self.motions is None else self.motions.at(i, j)

    def landed(self, i: int, j: int) -> BoolArray:
        """(n_pour,) which candies of a pour's recording count as poured in (Sec. III-B)."""
        assert self.grid is not None, "only asked of a pour"
        final, box = self.grid.recordings[i][j].positions_m[-1], self.containability.aabb_m
        with np.errstate(invalid="ignore"):
            if self.pouring.counted == "above_floor":
                return np.asarray(final[:, 2] >= box[0, 2], dtype=bool)
            return np.asarray(((final > box[0]) & (final < box[1])).all(axis=1), dtype=bool)

    def replay(self, i: int, j: int) -> Recording:
        """Return a pour's recording, in which what was spilled lies on the ground."""
        assert self.grid is not None, "only asked of a pour"
        recording = self.grid.recordings[i][j]
        return make_replay(recording, self.landed(i, j), self.ground_m, self.candy_extents_m).recording


@dataclass(frozen=True, eq=False)
class PoursKey:
    """What is to be read; read again at every refresh, because the choice and the motions come and go.

    Attributes:
        folder: the session's, with a finished stage `pouring`.
        cell: whose arm is to make the pours; none: not known yet.
        shown: what was shown last; imagined pours that are the same are not read again.
    """

    folder: Path
    cell: CellSettings | None
    shown: ShownPours | None


def load_pours(key: PoursKey) -> ShownPours:
    """Read a session's pours, what is known of the arm of a cell, and what a person chose.

    Raises:
        SessionError: something cannot be read.
    """
    view = SessionView.of(key.folder)
    session, record = view.session, view.session.record("pouring")
    if record is None:
        raise SessionError(f"The session {key.folder} holds no pours; imagine first.")
    tries = session.record("risk")
    shown = key.shown
    if shown is None or (shown.folder, shown.record, shown.tries) != (key.folder, record, tries):
        shown = _imagined(view, record, tries)
    motions = current_motions(session, key.cell) if key.cell is not None and shown.is_in_cell else None
    try:
        operator, problem = read_operator_choice(key.folder, record.digest), ""
    except SessionError as error:
        operator, problem = None, str(error)
    return replace(shown, motions=motions, operator=operator, problem=problem)


def _imagined(view: SessionView, record: StageRecord, tries: StageRecord | None) -> ShownPours:
    """Read what was imagined."""
    if view.containability is None:
        raise SessionError(f"The session {view.session.path} holds no verdict; imagine first.")
    parameters = view.parameters_of("pouring")
    surface = read_ply(view.session.folder(view.source) / "mesh.ply")
    cup, candy = cup_surface(parameters.pouring.cup), candy_mesh(parameters.particle)
    return ShownPours(
        folder=view.session.path,
        record=record,
        tries=tries,
        containability=view.containability,
        grid=view.grid,
        choice=None if view.tries is None else view.tries.choice,
        imagined_risk=None if view.tries is None else view.tries.risk,
        paper_choice=view.paper_choice,
        amount=view.amount,
        pouring=parameters.pouring,
        candy=(candy.vertices_m, candy.faces),
        candy_extents_m=particle_extents_m(parameters.particle),
        ground_m=float(surface.aabb_min_m[2]),
        body=in_colors(prepare_mesh(surface.vertices_m, surface.faces, is_shaded=True), surface, view),
        casters_m=surface_points_m(surface.vertices_m, surface.faces, _N_CASTERS),
        cup=prepare_mesh(cup.vertices_m, cup.faces),
        fill_line=_fill_line(surface, view),
        is_in_cell=view.source != "mesh",
    )


def _fill_line(surface: TriangleMesh, view: SessionView) -> FillBand | None:
    amount, judgement = view.amount, view.judgement
    capacity = None if judgement is None else judgement.capacity
    if amount is None or capacity is None or capacity.hollows is None or amount.fill_height_m <= 0:
        return None
    line = fill_line(surface, capacity.hollows, capacity.hollows.lowest_m + amount.fill_height_m)
    if not len(line.ends_m):
        return None
    band = prepare_mesh(*band_mesh(line.ends_m, line.normals, _BAND_M, _BAND_APART_M))
    return FillBand(band, line.ends_m[line.ends_m[:, 0, 1].argmax(), 0], amount.n_total)
