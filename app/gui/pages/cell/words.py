"""What the Cell page says of each step."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from PySide6.QtCore import QCoreApplication

from app.gui.views.state_mark import State
from app.operations.calibration import step_names
from app.operations.calibration.steps import StepState

translate = QCoreApplication.translate
STATES: dict[StepState, State] = {
    StepState.OPEN: "empty",
    StepState.DONE: "fresh",
    StepState.STALE: "stale",
    StepState.FAILED: "failed",
}


@dataclass(frozen=True)
class StepWords:
    """A step for people.

    Attributes:
        title: its name.
        what: what is done, and what a person has to do for it.
        do: what its button says.
        again: what the button says when the step was done before.
    """

    title: str
    what: str
    do: str
    again: str


def step_words(step: str, is_simulated: bool) -> StepWords:
    """Return the words of a step."""
    if step == step_names.BOARD and is_simulated:
        what = translate(
            "CellPage", "The simulated board lies on the platform already; its squares measure 30 mm."
        )
    elif step == step_names.BOARD:
        what = translate(
            "CellPage",
            "Print the sheet at 100 %, see that its bar measures 100 mm, and glue it flat onto something "
            "stiff. Measure a whole row of squares, and enter the side of one.",
        )
    elif is_simulated:
        what = _what(step)
    else:
        what = f"{_what(step)} {_by_hand(step)}".rstrip()
    title, do, again = _titles()[step]
    return StepWords(title, what, do, again)


def _titles() -> dict[str, tuple[str, str, str]]:
    """Title, button, and button when it was done before, by step."""
    return {
        step_names.ARM: (
            translate("CellPage", "Arm"),
            translate("CellPage", "Find the arm"),
            translate("CellPage", "Look again"),
        ),
        step_names.CAMERA: (
            translate("CellPage", "Camera"),
            translate("CellPage", "Try the camera"),
            translate("CellPage", "Try again"),
        ),
        step_names.BOARD: (
            translate("CellPage", "Calibration board"),
            translate("CellPage", "Enter the measured side"),
            translate("CellPage", "Enter another side"),
        ),
        step_names.HAND_EYE: (
            translate("CellPage", "Camera on the arm"),
            translate("CellPage", "Calibrate"),
            translate("CellPage", "Calibrate again"),
        ),
        step_names.CHECK: (
            translate("CellPage", "Independent check"),
            translate("CellPage", "Check"),
            translate("CellPage", "Check again"),
        ),
        step_names.TABLE: (
            translate("CellPage", "Platform and table"),
            translate("CellPage", "Measure the platform"),
            translate("CellPage", "Measure again"),
        ),
        step_names.VIEWS: (
            translate("CellPage", "Scan views"),
            translate("CellPage", "Choose the views"),
            translate("CellPage", "Choose again"),
        ),
        step_names.REFERENCE: (
            translate("CellPage", "Reference view"),
            translate("CellPage", "Store a reference view"),
            translate("CellPage", "Store another one"),
        ),
        step_names.CUP: (
            translate("CellPage", "Cup and station"),
            translate("CellPage", "Enter the cup"),
            translate("CellPage", "Enter it again"),
        ),
        step_names.DRY_RUN: (
            translate("CellPage", "Dry run"),
            translate("CellPage", "Begin the dry run"),
            translate("CellPage", "Make another one"),
        ),
    }


def _what(step: str) -> str:
    return {
        step_names.ARM: translate(
            "CellPage", "Asks the controller what it is, and whether it can be used. Nothing moves."
        ),
        step_names.CAMERA: translate(
            "CellPage", "Takes an image, and sees whether it has depth. Nothing moves."
        ),
        step_names.HAND_EYE: translate(
            "CellPage",
            "The arm looks at the board from many sides, and finds where the camera hangs. Views that are no "
            "good are refused and replaced. It is accepted only if views that the fit did not see agree.",
        ),
        step_names.CHECK: translate(
            "CellPage",
            "The board lies elsewhere, and the arm looks at it from all sides: each view must have it at the "
            "same place. Nothing is fitted.",
        ),
        step_names.TABLE: translate(
            "CellPage",
            "The board lies on the middle of the platform. Its plane gives the platform's height, and the "
            "crop box follows.",
        ),
        step_names.VIEWS: translate(
            "CellPage",
            "Chooses from where this arm scans what may fill the crop box, over all sides that it reaches. "
            "Nothing moves.",
        ),
        step_names.REFERENCE: translate(
            "CellPage",
            "The arm looks at the board once more. Each scan takes the same look again, and says if the "
            "camera has moved since.",
        ),
        step_names.CUP: translate(
            "CellPage",
            "Where the cup’s foot stands, its size, and the masses. Whether the arm can take it and pour is "
            "seen at once. Nothing moves.",
        ),
        step_names.DRY_RUN: translate(
            "CellPage",
            "The arm takes the empty cup, pours nothing into a bowl in the middle of the platform, and puts "
            "the cup back, at 30 % of its speed.",
        ),
    }[step]


def _by_hand(step: str) -> str:
    """What somebody has to do at a real cell."""
    return {
        step_names.HAND_EYE: translate(
            "CellPage",
            "Lay the board flat near the platform, and guide the arm by hand to where the camera sees all of "
            "it.",
        ),
        step_names.CHECK: translate(
            "CellPage",
            "Afterwards, guide the hand until its tip is on a corner where two black squares meet, and read "
            "it: that tells without the camera.",
        ),
        step_names.CUP: translate(
            "CellPage",
            "To teach it, guide the open hand around the standing cup, as it shall hold it, and read.",
        ),
        step_names.DRY_RUN: translate(
            "CellPage",
            "Clear the platform, and put the empty cup on its station. Each move waits for Go on; Cancel and "
            "STOP let the arm come to rest.",
        ),
    }.get(step, "")


def when(time: str) -> str:
    """Return a record's time as it is shown: the hour of today, else the day."""
    if not time:
        return ""
    try:
        then = datetime.fromisoformat(time).astimezone()
    except ValueError:
        return ""
    is_today = then.date() == datetime.now().astimezone().date()
    return f"{then:%H:%M}" if is_today else f"{then:%Y-%m-%d}"


def capitalized(sentence: str) -> str:
    """Return a figure as a line of its own."""
    return sentence[:1].upper() + sentence[1:]
