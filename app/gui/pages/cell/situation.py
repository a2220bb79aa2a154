"""What may be done on the Cell page now, and what is said. Knows no widgets."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication

from app.gui.pages.cell.loading import CellContents
from app.gui.pages.cell.words import capitalized, step_words
from app.gui.views.state_mark import State
from app.jobs.cell_events import BoardSought
from app.operations.calibration import step_names
from app.operations.calibration.steps import Step, StepState

translate = QCoreApplication.translate
_NEEDS = {
    step_names.HAND_EYE: step_names.BOARD,
    step_names.CHECK: step_names.HAND_EYE,
    step_names.TABLE: step_names.HAND_EYE,
    step_names.REFERENCE: step_names.HAND_EYE,
    step_names.DRY_RUN: step_names.CUP,
}
"""The step that must be done before another one."""
_SHOWN_REFUSALS = 3


@dataclass(frozen=True, eq=False)
class Situation:
    """Everything that what may be done depends on.

    Attributes:
        contents: of the cell's file and records; none before they are read.
        failure: why they cannot be read; empty if they can.
        steps: of the cell.
        step: the chosen one; empty if all are done.
        is_new: whether another cell is to be made.
        is_running: whether a step is under way.
        is_live: whether that one only shows what the camera sees.
        is_idle: whether no job is running.
        is_simulated: whether nothing real moves.
        is_arm_taken: whether the process that pours holds the real arm.
        is_paused: whether it was asked to wait.
        question: what the step under way waits for; empty if it does not.
        looks: at the board, of the step under way or the last one.
        n_planned: how many views of the board a calibration wants.
    """

    contents: CellContents | None
    failure: str
    steps: tuple[Step, ...]
    step: str
    is_new: bool
    is_running: bool
    is_live: bool
    is_idle: bool
    is_simulated: bool
    is_arm_taken: bool
    is_paused: bool
    question: str
    looks: tuple[BoardSought, ...]
    n_planned: int

    @property
    def chosen(self) -> Step | None:
        """The chosen step."""
        return next((step for step in self.steps if step.name == self.step), None)

    @property
    def can_pause(self) -> bool:
        """Whether the step under way goes from view to view."""
        return self.is_running and bool(self.looks)

    @property
    def can_undo(self) -> bool:
        """Whether the chosen step was done before."""
        return self.chosen is not None and bool(self.chosen.time)

    @property
    def can_continue(self) -> bool:
        """Whether a calibration was interrupted."""
        return self.step == step_names.HAND_EYE and self.contents is not None and self.contents.is_interrupted

    @property
    def primary_text(self) -> str:
        """What the page's button does."""
        if self.is_running and self.question:
            return translate("CellPage", "Go on")
        if self.is_running:
            return translate("CellPage", "Resume") if self.is_paused else translate("CellPage", "Pause")
        if self.is_new:
            return translate("CellPage", "Create the cell")
        chosen = self.chosen
        if chosen is None:
            return translate("CellPage", "Scan in this cell")
        if self.can_continue:
            return translate("CellPage", "Continue calibration")
        words = step_words(chosen.name, self.is_simulated)
        return words.do if chosen.state is StepState.OPEN else words.again


@dataclass(frozen=True)
class Now:
    """What is said below the view.

    Attributes:
        state: for the mark.
        headline: a sentence.
        details: further ones.
    """

    state: State
    headline: str
    details: tuple[str, ...] = ()


def now_of(now: Situation) -> Now:
    """Say what goes on, or is next."""
    if now.is_running:
        return _running(now)
    if now.contents is None and now.failure:
        return Now("failed", translate("CellPage", "The cell cannot be shown."), (now.failure,))
    if now.contents is None:
        return Now("empty", translate("CellPage", "Reading the cell file …"))
    if now.is_new:
        return Now(
            "empty",
            translate("CellPage", "From a bare table to a calibrated cell, step by step."),
            (
                translate("CellPage", "Give the new cell a name, and create it."),
                translate("CellPage", "Each step can be repeated alone, and undone."),
            ),
        )
    chosen = now.chosen
    if chosen is None:
        figures = {step.name: capitalized(step.figure) for step in now.steps}
        headline = translate("CellPage", "This cell is calibrated, checked, and ready to scan.")
        return Now(
            "fresh",
            headline,
            tuple(f"{figures[name]}." for name in (step_names.HAND_EYE, step_names.CHECK, step_names.VIEWS)),
        )
    n_done = sum(step.state is StepState.DONE for step in now.steps)
    title = step_words(chosen.name, now.is_simulated).title
    said = translate("CellPage", "{n} of {total} steps are done.").format(n=n_done, total=len(now.steps))
    if chosen.state is StepState.FAILED:
        return Now("failed", f"{title}: {chosen.figure}".rstrip(".") + ".", (_remedy(chosen.name), said))
    if chosen.state is StepState.STALE:
        return Now("stale", f"{title}: {chosen.figure}.", (said,))
    if chosen.state is StepState.DONE:
        return Now("fresh", f"{title}: {chosen.figure}.", (said,))
    if now.can_continue:
        headline = translate("CellPage", "The calibration was interrupted; its views are stored.")
        more = translate("CellPage", "Continue uses them; Start over leaves them aside.")
        return Now("stale", headline, (more, said))
    headline = translate("CellPage", "Next: {title}. {figure}.").format(
        title=title, figure=capitalized(chosen.figure)
    )
    return Now("empty", headline, (said,))


def obstacle_of(now: Situation) -> str:
    """Say what keeps the chosen step from being done; may be empty."""
    if now.is_new or now.is_running or now.chosen is None:
        return ""
    if now.is_arm_taken:
        return translate(
            "CellPage", "The arm is connected for pouring: disconnect it on the Robot page first."
        )
    needed = _NEEDS.get(now.step)
    before = next((step for step in now.steps if step.name == needed), None)
    if before is None or before.state is StepState.DONE:
        return ""
    title = step_words(before.name, now.is_simulated).title
    return translate("CellPage", "First comes the step “{title}”.").format(title=title)


def _running(now: Situation) -> Now:
    if now.question:
        return Now("stale", now.question, (translate("CellPage", "Go on says yes, Cancel says no."),))
    if now.is_paused:
        n = now.looks[-1].n_usable if now.looks else 0
        said = translate("CellPage", "Paused: {n} views of the board so far.").format(n=n)
        return Now("stale", said, (translate("CellPage", "The arm stops after the current view."),))
    if now.is_live:
        headline = translate("CellPage", "This is what the camera sees now.")
        return Now("running", headline, (translate("CellPage", "Hatched: no depth. Cancel ends it."),))
    alone = _alone(now.step)
    if alone:
        return Now("running", alone)
    if not now.looks:
        return Now("running", translate("CellPage", "Connecting to the cell …"))
    n = now.looks[-1].n_usable
    refused = tuple(
        translate("CellPage", "Look {number} is not used: {why}").format(number=look.number, why=look.problem)
        for look in now.looks
        if look.problem
    )
    if now.step == step_names.HAND_EYE:
        said = translate("CellPage", "Looking at the board: {n} of {total} views can be used.")
        if n >= now.n_planned:
            said = translate("CellPage", "Fitting where the camera hangs to {n} views …")
        headline = said.format(n=n, total=now.n_planned)
    else:
        headline = translate("CellPage", "Looking at the board from all sides: {n} views.").format(n=n)
    return Now("running", headline, refused[-_SHOWN_REFUSALS:])


def _alone(step: str) -> str:
    """What goes on in a step that does not look at the board; empty for the others."""
    return {
        step_names.ARM: translate("CellPage", "Asking the controller …"),
        step_names.CAMERA: translate("CellPage", "Taking an image …"),
        step_names.VIEWS: translate("CellPage", "Choosing views that show all sides …"),
        step_names.CUP: translate("CellPage", "Seeing whether the arm can pour with this cup …"),
        step_names.DRY_RUN: translate("CellPage", "The arm goes through a pour with an empty cup …"),
    }.get(step, "")


def _remedy(step: str) -> str:
    if step == step_names.CHECK:
        return translate(
            "CellPage", "Calibrate anew, and see that camera and board are fixed; undo takes the check back."
        )
    return translate("CellPage", "Fix what it says, then try again.")
