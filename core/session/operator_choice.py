"""The pour that a person chose instead of the program's, and why: `operator_choice.json` in the session."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from core.errors import InputError, SessionError
from core.files import read_json, write_json
from core.formats.tables import OperatorChoice as ChoiceTable
from core.session.explaining import explained
from core.session.record import utc_now

CHOICE_FILE = "operator_choice.json"


@dataclass(frozen=True)
class OperatorChoice:
    """Which pour somebody wants.

    Attributes:
        i: index of its direction.
        j: index of its distance.
        reason: in their words; never empty.
        imagination: digest of the imagined pours that it is one of.
        time: ISO 8601, UTC.
    """

    i: int
    j: int
    reason: str
    imagination: str
    time: str


def write_operator_choice(session: Path, i: int, j: int, reason: str, imagination: str) -> OperatorChoice:
    """Keep a choice in a session's folder, whole or not at all; it replaces an earlier one.

    Raises:
        InputError: no reason is given.
        SessionError: the folder cannot be written.
    """
    reason = " ".join(reason.split())
    if not reason:
        raise InputError("Another pour than the program's needs a reason; say in a few words why.")
    choice = OperatorChoice(i, j, reason, imagination, utc_now())
    with explained(session):
        write_json(session / CHOICE_FILE, asdict(choice))
    return choice


def read_operator_choice(session: Path, imagination: str) -> OperatorChoice | None:
    """Return what somebody chose among these imagined pours; none if nobody did, or it was among others.

    Raises:
        SessionError: the file is damaged. What a person decided is never passed over in silence.
    """
    path = session / CHOICE_FILE
    if not path.is_file():
        return None
    try:
        choice = OperatorChoice(**read_json(path, ChoiceTable))
    except SessionError as error:
        raise damaged_choice(session) from error
    return choice if choice.imagination == imagination else None


def withdraw_operator_choice(session: Path) -> None:
    """Let the program choose again; nothing happens if nobody had chosen.

    Raises:
        SessionError: the folder cannot be written.
    """
    with explained(session):
        (session / CHOICE_FILE).unlink(missing_ok=True)


def damaged_choice(session: Path) -> SessionError:
    """Return the error that says what to do about a choice that is none."""
    return SessionError(
        f"{session / CHOICE_FILE}, the pour that the operator chose, is damaged; "
        "choose again, or withdraw the choice."
    )
