"""Which pour is made: those that the arm can make, and the operator's choice instead of the program's."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from core.errors import InputError, MotionError, SessionError
from core.imagination.results import PourGrid
from core.motion.pour.feasibility import PourMotions
from core.pipeline.freshness import cell_text
from core.pipeline.session_view import SessionView
from core.report import place_text
from core.session import Session
from core.session.operator_choice import OperatorChoice, write_operator_choice

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings


def described_cell(settings: CellSettings) -> dict[str, Any]:
    """Return what of a cell decides whether a pour can be made, as the record of the motions holds it."""
    table: dict[str, Any] = json.loads(
        settings.model_dump_json(include={"robot", "gripper", "camera", "place", "motion", "obstacles"})
    )
    return table


def current_motions(session: Session, settings: CellSettings) -> PourMotions | None:
    """Return which of a session's pours a cell's arm can make; none if they changed since that was judged.

    Raises:
        SessionError: they cannot be read.
    """
    view = SessionView(session)
    record = view.records.get("motion")
    is_of_cell = record is not None and record.parameters.get("cell") == cell_text(described_cell(settings))
    return view.motions if is_of_cell else None


def choose_pour(session: Session, i: int, j: int, reason: str) -> OperatorChoice:
    """Choose pour (i, j) among those that a session holds now, instead of the program's.

    Raises:
        InputError: there is no such pour, or no reason.
        SessionError: no pours were imagined, or the folder cannot be written.
    """
    pours = SessionView(session).pours
    if pours is None:
        raise SessionError(
            f"The session {session.path} holds no imagined pours to choose among; imagine first."
        )
    n_directions, n_distances = len(pours.p), len(pours.indent_m)
    if not (0 <= i < n_directions and 0 <= j < n_distances):
        raise InputError(
            f"There is no pour {i}, {j}: directions go from 0 to {n_directions - 1}, "
            f"distances from 0 to {n_distances - 1}."
        )
    return write_operator_choice(session.path, i, j, reason, pours.digest)


def refuse_unfeasible(operator: OperatorChoice, grid: PourGrid, motions: PourMotions) -> None:
    """Refuse a choice that the arm cannot make.

    Raises:
        MotionError: why it cannot.
    """
    found = motions.at(operator.i, operator.j)
    if not found.is_feasible:
        raise MotionError(
            "The arm cannot make the pour that the operator chose, from "
            f"{place_text(grid, operator.i, operator.j)}: {found.reason} "
            "Choose another one, or withdraw the choice."
        )
