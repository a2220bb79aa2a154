"""What the page shows of a session, read in a thread. No Qt here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.views.scene.prepared import PreparedMesh, prepare_mesh
from app.motion_record import current_motions
from core.errors import SessionError
from core.files import read_json
from core.geometry import BoolArray
from core.imagination.amount.result import AMOUNT_FILE, Amount
from core.imagination.choice import choose_pour
from core.imagination.rendering.shapes import cup_surface
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import RISK_FILE, PourRisk
from core.motion.pour.choosing import PourMotions
from core.motion.pour.plan import PourFeasibility
from core.parameters.imagination import ParticleParameters, PouringParameters
from core.pipeline.needs import source_of
from core.ply import read_ply
from core.session import Session
from core.session.operator_choice import OperatorChoice, read_operator_choice

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings


@dataclass(frozen=True)
class ShownPours:
    """Everything about a session's pours.

    Attributes:
        folder: the session's.
        digest: of the imagined pours.
        containability: the verdict before them.
        grid: none if the object is no open container.
        choice: what the imagination alone would choose; none without a grid.
        imagined_risk: of the pours, whether or not the arm can make them; none if no tries were made.
        paper_choice: what the paper's rule says; none without a grid.
        amount: how many candies shall go in; none if it is not known what the object holds.
        motions: which ones the cell's arm can make; none if that is not known.
        operator: what a person chose; none if nobody did.
        problem: why it is not known what a person chose; empty if it is.
        pouring: what was imagined with.
        candy_radius_m: half a candy's diameter.
        body: the object.
        cup: in its own frame.
        stands_in_cell: false for an imported mesh, which no arm is asked about.
    """

    folder: Path
    digest: str
    containability: Containability
    grid: PourGrid | None
    choice: PourChoice | None
    imagined_risk: PourRisk | None
    paper_choice: PourChoice | None
    amount: Amount | None
    motions: PourMotions | None
    operator: OperatorChoice | None
    problem: str
    pouring: PouringParameters
    candy_radius_m: float
    body: PreparedMesh
    cup: PreparedMesh
    stands_in_cell: bool

    @property
    def risk(self) -> PourRisk | None:
        """All tries: those among the pours that the arm can make too, where it was asked."""
        known = None if self.motions is None else self.motions.risk
        return known or self.imagined_risk

    @property
    def program_choice(self) -> PourChoice | None:
        """What the program would pour: the arm's choice where it was asked."""
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


def load_pours(folder: Path, cell: CellSettings | None, before: ShownPours | None) -> ShownPours:
    """Read a session's pours, and what is known of the arm of a cell.

    Args:
        folder: the session's, with a finished stage `pouring`.
        cell: the cell to ask about; none: not known yet.
        before: what was shown last; what is the same is not read again.

    Raises:
        SessionError: something cannot be read.
    """
    session = Session.open(folder)
    record = session.record("pouring")
    if record is None:
        raise SessionError(f"The session {folder} holds no pours; imagine first.")
    is_mesh = source_of(session) == "mesh"
    motions = None if cell is None or is_mesh else current_motions(session, cell)
    operator, problem = _operator(folder, record.digest)
    is_known = before is not None and (before.folder, before.digest) == (folder, record.digest)
    containability = Containability.load(session.folder("containability"))
    stage = session.folder("pouring")
    table = read_json(stage / "choice.json")["choice"]
    pouring = PouringParameters.model_validate(record.parameters["pouring"])
    surface = read_ply(session.folder(source_of(session)) / "mesh.ply")
    cup = cup_surface(pouring.cup)
    grid = before.grid if is_known and before is not None else None
    if table is not None and grid is None:
        grid = PourGrid.load(stage)
    return ShownPours(
        folder,
        record.digest,
        containability,
        grid,
        None if table is None else PourChoice.from_table(table),
        PourRisk.load(stage) if (stage / RISK_FILE).is_file() else None,
        None if grid is None else choose_pour(grid, pouring.cup),
        Amount.from_table(read_json(stage / AMOUNT_FILE)) if (stage / AMOUNT_FILE).is_file() else None,
        motions,
        operator,
        problem,
        pouring,
        ParticleParameters.model_validate(record.parameters["particle"]).diameter_m / 2,
        prepare_mesh(surface.vertices_m, surface.faces),
        prepare_mesh(cup.vertices_m, cup.faces),
        not is_mesh,
    )


def _operator(folder: Path, digest: str) -> tuple[OperatorChoice | None, str]:
    try:
        return read_operator_choice(folder, digest), ""
    except SessionError as error:
        return None, str(error)
