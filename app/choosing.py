"""`poursight choose`: a person's pour instead of the program's, with the reason."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.errors import InputError, MotionError, SessionError
from core.files import read_json
from core.imagination.results import PourGrid
from core.motion.pour.choosing import PourMotions
from core.report import place_text
from core.session import Session
from core.session.operator_choice import OperatorChoice, withdraw_operator_choice, write_operator_choice


def choose(session_folder: Path, i: int, j: int, reason: str) -> None:
    """Take pour (i, j) of a session from now on.

    Raises:
        InputError: there is no such pour, or no reason.
        SessionError: no pours were imagined, or the folder cannot be written.
    """
    made = keep_choice(Session.open(session_folder), i, j, reason)
    print(
        f"Pour {made.i}, {made.j} is chosen ({made.reason}). 'poursight plan {session_folder}' tells whether "
        "the arm can make it."
    )


def withdraw(session_folder: Path) -> None:
    """Let the program choose again."""
    withdraw_operator_choice(Session.open(session_folder).path)
    print("The program chooses again.")


def keep_choice(session: Session, i: int, j: int, reason: str) -> OperatorChoice:
    """Keep a choice among the pours that a session holds now.

    Raises:
        InputError: there is no such pour, or no reason.
        SessionError: no pours were imagined, or the folder cannot be written.
    """
    record = session.record("pouring")
    if record is None or "pours.json" not in record.files:
        raise SessionError(
            f"The session {session.path} holds no imagined pours to choose among; imagine first."
        )
    table: dict[str, Any] = read_json(session.folder("pouring") / "pours.json")
    directions, distances = len(table["theta_rad"]), len(table["indent_m"])
    if not (0 <= i < directions and 0 <= j < distances):
        raise InputError(
            f"There is no pour {i}, {j}: directions go from 0 to {directions - 1}, "
            f"distances from 0 to {distances - 1}."
        )
    return write_operator_choice(session.path, i, j, reason, record.digest)


def refuse_unmakeable(operator: OperatorChoice, grid: PourGrid, motions: PourMotions) -> None:
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
