"""The side's panels before and while the arm moves: connect and plan, check, follow the moves."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QPushButton, QVBoxLayout, QWidget

from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.robot.motion import ShownMotion, move_text
from app.gui.theme import GRID_PX
from app.gui.views.labels import say, text_label
from app.gui.views.painting import tabular
from app.gui.views.progress_line import ProgressLine
from app.jobs.arm_events import MoveProgress, PlannedPour
from core.motion.pour.plan import Segment
from core.report.sentences import duration_text
from core.session.cups import Cup

if TYPE_CHECKING:
    from core.motion.pour.plan import PourPlan
    from hardware.cell.settings import CellSettings

_MM = 1000.0
_SLOWER_S = 0.05
"""A pour rotation that is slower than imagined by less is not worth a word."""


class Panel(QWidget):
    """A column that begins with a heading.

    Attributes:
        heading: what the step is.
        column: takes the rest.
    """

    def __init__(self, name: str, heading: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.heading = text_label(f"{name}_heading", "verdict", heading)
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.setSpacing(GRID_PX)
        self.column.addWidget(self.heading)


class StartPanel(Panel):
    """Before there is a plan: what the primary button will do, and what was in the way the last time.

    Attributes:
        emptied: somebody took out of the object what the cups before had poured.
    """

    emptied = Signal()

    def __init__(self) -> None:
        super().__init__("start_panel", "")
        self._text = text_label("start_text")
        self._note = text_label("start_note", "attention")
        self._failure = text_label("start_failure", "failed")
        self._empty = QPushButton(self.tr("The object was emptied: start with cup 1"))
        self._empty.setObjectName("object_emptied")
        self._empty.clicked.connect(self.emptied)
        for widget in (self._note, self._failure, self._text, self._empty):
            self.column.addWidget(widget)

    def show_missing(self, heading: str, text: str) -> None:
        """Say why there is no pour to make."""
        self._show(heading, text)

    def show_connect(self, cell: CellSettings | None, farewell: str, failure: str) -> None:
        """Say what connecting does."""
        if cell is None:
            text = self.tr("Reading the cell file …")
        elif cell.robot.is_real:
            text = self.tr(
                "The {name} has a real {model} at {address}. Connecting moves nothing; it starts a program "
                "on a controller that runs no other, and sets tool frame, payload and tool voltage there."
            ).format(name=cell.name, model=cell.robot.model, address=cell.robot.address)
        else:
            text = self.tr(
                "The {name} has a simulated {model}, {n:g} times as fast as a real one, controlled by the "
                "same driver. Nothing real moves."
            ).format(name=cell.name, model=cell.robot.model, n=cell.simulation.speed_up)
        self._show(self.tr("Connect the arm"), text, farewell, failure)

    def show_plan(self, is_gripper_closed: bool, has_backed_off: bool, failure: str, cup: Cup) -> None:
        """Say what planning does, for which of several cups, and what has to be done before."""
        note = ""
        if is_gripper_closed:
            note = self.tr(
                "The gripper is closed and may hold a cup. Hold the cup, open the gripper below, and put the "
                "cup on its station."
            )
        elif has_backed_off:
            note = self.tr(
                "The arm is home again. Check that the cup stands on its station and is filled, then plan "
                "again."
            )
        text = self.tr(
            "The motion is planned from where the arm is now, checked sample by sample, and shown before "
            "anything moves."
        )
        if cup.number > 1:
            text += " " + self.tr("Next is {cup}; the candies of those before are in the object.").format(
                cup=cup.words
            )
        self._show(self.tr("Plan the pour"), text, note, failure)
        self._empty.setVisible(cup.number > 1)

    def show_way_back(self, failure: str) -> None:
        """Say that the cup of a pour that was not finished may be in the hand, and what can be done."""
        text = self.tr(
            "The gripper is closed and the last pour was not finished, so its cup may be in the hand. The "
            "way back is planned from where the arm is, and shown before anything moves."
        )
        note = self.tr("If the hand is empty, or you want to take the cup yourself, open the gripper below.")
        self._show(self.tr("A pour was not finished"), text, note, failure)

    def _show(self, heading: str, text: str, note: str = "", failure: str = "") -> None:
        self.heading.setText(heading)
        self._empty.hide()
        say(self._text, text)
        say(self._note, note)
        say(self._failure, failure)


class CheckPanel(Panel):
    """The plan in numbers, and what has to be confirmed before the arm moves.

    Attributes:
        ticked: something was ticked or not any more.
    """

    ticked = Signal()

    def __init__(self) -> None:
        super().__init__("check_panel", self.tr("Check, then hold to pour"))
        self._number = 0
        self._facts = FactGrid("plan_facts")
        self._note = text_label("plan_note", "muted")
        self._advice = text_label("pour_advice", "attention")
        self._anyway = self._check(
            "check_anyway",
            self.tr("Pour although it is not advised"),
            self.tr("Candies are likely to fall beside the object"),
        )
        self._rehearsal = text_label("rehearsal", "muted")
        self._expiry = text_label("plan_expiry", "muted")
        self._reason = text_label("hold_reason", "attention")
        self._cup = self._check("check_cup", "", self.tr("With the candies in it, upright on its mark"))
        self._checks = (
            self._cup,
            self._check(
                "check_area",
                self.tr("Nobody in the arm's reach"),
                self.tr("And no object that is not in the cell file"),
            ),
            self._check(
                "check_speed",
                self.tr("Speed slider set as I want it"),
                self.tr("On the teach pendant; below 100 % everything takes longer"),
            ),
            self._check(
                "check_stop",
                self.tr("Emergency stop within my reach"),
                self.tr("The red STOP of this window is a software stop and no substitute for it"),
            ),
        )
        confirm = text_label("checks_heading", "heading", self.tr("Before pouring, confirm:"))
        below = (self._rehearsal, self._expiry, self._reason)
        doubtful = (self._advice, confirm, self._anyway)
        for widget in (self._facts, self._note, *doubtful, *self._checks, *below):
            self.column.addWidget(widget)

    def show_plan(self, planned: PlannedPour, cup: Cup, *, is_rehearsal: bool) -> None:
        """Show a plan; every new one has to be confirmed anew, unless it is a rehearsal."""
        say(self._note, planned.note)
        self._facts.set_facts(plan_facts(planned.plan))
        if planned.number != self._number:
            self._number = planned.number
            for check in self._checks:
                with QSignalBlocker(check):  # whoever shows a plan looks at the ticks afterwards
                    check.setChecked(is_rehearsal)
            with QSignalBlocker(self._anyway):
                self._anyway.setChecked(not planned.advice)
        say(self._advice, planned.advice)
        self._anyway.setVisible(bool(planned.advice))
        said = self.tr("Cup on its station, {n} candies in it")
        if cup.n_cups > 1:
            said = self.tr("Cup {k} of {cups} on its station, {n} candies in it")
        self._cup.setText(said.format(n=cup.n_candies, k=cup.number, cups=cup.n_cups))
        self._cup.setAccessibleName(self._cup.text())
        said = self.tr("SIMULATED: already ticked. With a real arm, you tick each point yourself.")
        say(self._rehearsal, said if is_rehearsal else "")
        self.update_expiry(planned)

    def update_expiry(self, planned: PlannedPour) -> None:
        """Say how long the plan is still valid, and what keeps the arm from moving."""
        left_s = planned.expires_s - time.monotonic()
        said = self.tr("The plan is valid for another {time}.").format(time=duration_text(left_s))
        say(self._expiry, said if left_s > 0 else "")
        say(self._reason, self.reason(planned))

    def reason(self, planned: PlannedPour) -> str:
        """Why the arm must not move yet; empty if it may."""
        if time.monotonic() >= planned.expires_s:
            return self.tr("The plan has expired; plan again.")
        checks = (self._anyway, *self._checks)
        left = sum(not check.isChecked() for check in checks)
        if left >= len(self._checks):
            return self.tr("Tick each point once you have checked it.")
        return self.tr("{n} more to tick.").format(n=left) if left else ""

    def _check(self, name: str, text: str, tip: str) -> QCheckBox:
        check = QCheckBox(text)
        check.setObjectName(name)
        check.setAccessibleName(text)
        check.setToolTip(tip)
        check.setMinimumHeight(3 * GRID_PX)
        check.toggled.connect(lambda _: self.ticked.emit())
        return check


class LivePanel(Panel):
    """While the arm moves: which move, how far, how much longer."""

    def __init__(self) -> None:
        super().__init__("live_panel", "")
        self._move = text_label("live_move")
        self._move.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._move.setMinimumHeight(2 * self._move.fontMetrics().height())  # nothing below jumps
        self._bar = ProgressLine()
        self._bar.setObjectName("live_bar")
        self._bar.setAccessibleName(self.tr("Progress of the motion"))
        self._left = text_label("live_left", "heading")
        self._left.setFont(tabular(self.font()))
        self._pivot = text_label("live_pivot", "muted")
        self._pivot.setFont(tabular(self.font()))
        kept = self._pivot.sizePolicy()
        kept.setRetainSizeWhenHidden(True)
        self._pivot.setSizePolicy(kept)
        self._pivot.setToolTip(self.tr("From the joint angles that the controller reports"))
        said = self.tr("STOP, or its key F12, stops the arm at once; it stays where it is.")
        stop = text_label("live_stop", "muted", said)
        for widget in (self._move, self._bar, self._left, self._pivot, stop):
            self.column.addWidget(widget)

    def begin(self, is_return: bool) -> None:
        """Nothing has moved yet."""
        self.heading.setText(self.tr("Backing off") if is_return else self.tr("Pouring"))
        say(self._move, self.tr("The whole plan is checked once more before anything moves."))
        self._bar.set_fraction(0.0)
        say(self._left, "")
        say(self._pivot, "")

    def follow(self, progress: MoveProgress, motion: ShownMotion) -> None:
        """Show how far it is."""
        say(self._move, move_text(Segment(progress.name)))
        self._bar.set_fraction(progress.done_s / motion.duration_s)
        said = self.tr("Move {k} of {n}, about {left} left").format(
            k=progress.index + 1, n=len(motion.moves), left=duration_text(progress.left_s)
        )
        say(self._left, said)
        off_m = progress.pivot_off_m
        said = self.tr("The pivot is {mm:.2f} mm from its place.")
        say(self._pivot, "" if off_m is None else said.format(mm=off_m * _MM))


def plan_facts(plan: PourPlan) -> list[Fact]:
    """Return what a person wants to know of a plan before it is carried out."""
    tr = partial(QCoreApplication.translate, "PlanFacts")
    rotation = tr("{seconds:.1f} s").format(seconds=plan.turn_s)
    slower_s = plan.turn_s - plan.imagined_turn_s
    if slower_s > _SLOWER_S:
        rotation += tr(", {slower:.1f} s slower than imagined").format(slower=slower_s)
    return [
        Fact(
            tr("Duration"),
            tr("{n} moves, {time}").format(n=len(plan.moves), time=duration_text(plan.duration_s)),
            tr("How long the arm moves, without the gripper's own time; from the plan"),
            is_wide=True,
        ),
        Fact(
            tr("Pour rotation"),
            rotation,
            tr("Time of the rotation that pours; imagined: {imagined:.1f} s, without speeding up").format(
                imagined=plan.imagined_turn_s
            ),
            is_wide=True,
        ),
        Fact(
            tr("Arm clearance"),
            tr("{mm:.0f} mm, {first} to {second}").format(
                mm=plan.clearance_m * _MM, first=plan.nearest[0], second=plan.nearest[1]
            ),
            tr("Smallest distance of arm, gripper and camera to anything along the path; from the plan"),
            is_wide=True,
        ),
        Fact(
            tr("Cup clearance"),
            tr("{mm:.0f} mm").format(mm=plan.cup_clearance_m * _MM),
            tr("Smallest distance of the held cup to anything but what it stands on; from the plan"),
            is_wide=True,
        ),
        Fact(
            tr("Pivot"),
            tr("stays within {mm:.2f} mm").format(mm=max(plan.pivot_error_m * _MM, 0.01)),
            tr("How far the point of the rim that the cup rotates about moves meanwhile; from the plan"),
            is_wide=True,
        ),
    ]
