"""What comes next with the arm, and what a session still needs before it can pour. Knows no widgets."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import QCoreApplication

from app.gui.desk.workspace import Workspace
from app.jobs.arm_events import ArmStatus
from core.pipeline.session_view import IMAGINED


class Step(Enum):
    """One thing at a time; the value is the number in the row of steps, 0 where none of them is current."""

    EMPTY = "empty", 0
    CONNECT = "connect", 1
    PLAN = "plan", 2
    CHECK = "check", 3
    POUR = "pour", 4
    OUTCOME = "outcome", 5
    STOPPED = "stopped", 4
    PLAN_BACK_OFF = "plan the return", 4
    CHECK_BACK_OFF = "check the return", 4
    BACK_OFF = "return", 4

    @property
    def number(self) -> int:
        """Its place among connect, plan, check, pour and outcome."""
        return self.value[1]

    @property
    def is_recovery(self) -> bool:
        """Whether it is about coming back after a stop."""
        return self in (Step.STOPPED, Step.PLAN_BACK_OFF, Step.CHECK_BACK_OFF)

    @property
    def is_moving(self) -> bool:
        """Whether the arm moves."""
        return self in (Step.POUR, Step.BACK_OFF)


class Activity(Enum):
    """The job with the arm that is under way."""

    NONE = "none"
    CONNECTING = "connecting"
    PLANNING = "planning"
    POURING = "pouring"
    COUNTING = "counting"
    RECOVERING = "recovering"
    PLANNING_BACK_OFF = "planning the return"
    BACKING_OFF = "returning"
    GRIPPING = "gripping"


@dataclass(frozen=True)
class Situation:
    """Everything that the next step depends on.

    Attributes:
        activity: the job under way.
        status: of the connected arm; none if none is connected.
        is_connected: whether the cell's arm is.
        can_pour: whether the session holds a pour to be made.
        has_plan: whether a pour was planned.
        has_back_off: whether the return after a stop was planned.
        has_run: whether a run waits for its outcome.
    """

    activity: Activity
    status: ArmStatus | None
    is_connected: bool
    can_pour: bool
    has_plan: bool
    has_back_off: bool
    has_run: bool

    @property
    def step(self) -> Step:
        """What comes next; coming back after a stop comes before anything else."""
        if self.activity is Activity.POURING:
            return Step.POUR
        if self.activity is Activity.BACKING_OFF:
            return Step.BACK_OFF
        if self.status is not None and self.status.problem:
            return Step.STOPPED
        if self.status is not None and self.status.must_back_off:
            return Step.CHECK_BACK_OFF if self.has_back_off else Step.PLAN_BACK_OFF
        if self.has_run:
            return Step.OUTCOME
        if not self.can_pour:
            return Step.EMPTY
        if not self.is_connected:
            return Step.CONNECT
        return Step.CHECK if self.has_plan else Step.PLAN


@dataclass(frozen=True)
class Missing:
    """Something that is not there yet.

    Attributes:
        heading: what it is.
        text: why it is needed.
        button: what the primary button says; empty: there is none.
        page: key of the page that the button leads to.
    """

    heading: str
    text: str
    button: str = ""
    page: str = ""


def missing_for_a_pour(workspace: Workspace, is_container: bool | None) -> Missing | None:
    """Return what is missing first; none if a pour can be planned.

    Args:
        workspace: with the session.
        is_container: what was imagined; none if that is not known.
    """
    translate = QCoreApplication.translate
    to_scan = translate("Missing", "Go to Scan"), "scan"
    to_imagination = translate("Missing", "Go to Imagine"), "imagination"
    if workspace.has("mesh"):
        said = translate(
            "Missing",
            "This session holds an imported mesh, so the object's place in the cell is not known. To let the "
            "arm pour, start a new session and scan the object.",
        )
        return Missing(translate("Missing", "An imported mesh has no place in the cell"), said, *to_scan)
    if not workspace.has("scan"):
        said = translate("Missing", "Here the arm pours candies into the object. Scan the object first.")
        return Missing(translate("Missing", "No object yet"), said, *to_scan)
    if not workspace.has("pouring"):
        said = translate("Missing", "Here the arm executes the best of the imagined pours. Imagine first.")
        return Missing(translate("Missing", "No pours yet"), said, *to_imagination)
    if not all(workspace.is_fresh(stage) for stage in IMAGINED):
        said = translate("Missing", "Something they depend on has changed since. Imagine again.")
        return Missing(translate("Missing", "The pours are out of date"), said, *to_imagination)
    if workspace.is_undecided:
        said = translate(
            "Missing",
            "Whether candies would stay in it depends on what no view saw. Look again from further views.",
        )
        return Missing(translate("Missing", "Not known to be a container"), said, *to_scan)
    if is_container is False:
        said = translate(
            "Missing",
            "This object is not an open container: candies would not stay in it, so no pours were imagined.",
        )
        button = translate("Missing", "See why")
        return Missing(translate("Missing", "Nothing to pour into"), said, button, "imagination")
    return None
