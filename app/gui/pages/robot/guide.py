"""Which words and buttons the side shows in each step."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject

from app.gui.desk.desk import Desk
from app.gui.pages.robot.course import Course
from app.gui.pages.robot.loading import Standing
from app.gui.pages.robot.needs import Missing, missing_for_a_pour
from app.gui.pages.robot.side_part import RobotSide
from app.gui.pages.robot.steps import Doing, Step
from core.session.pour_runs import PourRun
from hardware.readiness import unreadiness


class Guide(QObject):
    """Fills the side from how everything stands.

    Attributes:
        missing: what the session still needs; none if a pour can be planned.
    """

    def __init__(self, desk: Desk, course: Course, side: RobotSide) -> None:
        super().__init__(side)
        self.missing: Missing | None = None
        self._desk, self._course, self._side = desk, course, side
        self._step: Step | None = None
        self._asked: tuple[Path, PourRun | None] | None = None

    def show(self, standing: Standing | None) -> None:
        """Show the step that comes next."""
        self.missing = self._missing(standing)
        self._course.is_possible = self.missing is None
        step = self._course.step
        if step.is_moving and self._step is not step:
            self._side.live.begin(step is Step.BACKING)
        if step is not Step.OUTCOME:
            self._asked = None
        self._step = step
        self._side.show_step(step)
        self._fill(step, standing)
        self.look()

    def look(self) -> None:
        """Enable what can be done now."""
        course, side = self._course, self._side
        step, is_idle = course.step, self._desk.jobs.is_idle
        situation = course.situation
        side.primary.setText(self._primary_text(step))
        side.primary.setVisible(bool(side.primary.text()))
        is_ready = is_idle or step is Step.EMPTY
        if step is Step.CONNECT:
            is_ready = is_ready and self._desk.cell.settings is not None
        if step is Step.PLAN:
            is_ready = is_ready and not self._is_gripper_closed
        if step is Step.OUTCOME:
            is_ready = is_ready and side.outcome.is_complete
        side.primary.setEnabled(is_ready)
        side.again.setEnabled(is_idle)
        side.again.setText(self.tr("Plan again") if step is Step.CHECK else self.tr("Pour again"))
        busy = None if is_idle else self.tr("Another job is under way.")
        side.hold_to_back_off.set_blocked(busy)
        if course.planned is not None and step is Step.CHECK:
            side.check.look(course.planned)
            side.hold_to_pour.set_blocked(busy or side.check.reason(course.planned) or None)
        is_at_rest = is_idle and situation.status is not None and not step.is_recovery
        may_leave = is_idle and step in (Step.EMPTY, Step.PLAN, Step.OUTCOME)
        side.state.let_do(may_leave, is_at_rest and step is Step.PLAN)

    def _fill(self, step: Step, standing: Standing | None) -> None:
        course, side, arm = self._course, self._side, self._desk.arm
        status = course.situation.status
        if step is Step.EMPTY and self.missing is not None:
            side.start.show_missing(self.missing.heading, self.missing.text)
        elif step is Step.CONNECT:
            side.start.show_connect(self._desk.cell.settings, arm.farewell, course.failure)
        elif step is Step.PLAN:
            is_closed = self._is_gripper_closed
            failure = course.failure or course.stopped
            side.start.show_plan(is_closed, course.has_backed_off, failure, course.cup)
            if is_closed:
                side.state.unfold()
        elif step is Step.CHECK and course.planned is not None:
            side.check.show_plan(course.planned, course.cup, is_rehearsal=self._desk.cell.is_simulated)
        elif step.is_recovery and status is not None:
            side.recovery.show_step(step, self._what_happened(step), status.must_back_off, course.failure)
        elif step is Step.OUTCOME and course.run is not None:
            self._ask(course.run, standing)

    @property
    def _is_gripper_closed(self) -> bool:
        status = self._course.situation.status
        return status is not None and bool(status.is_gripper_closed)

    def _missing(self, standing: Standing | None) -> Missing | None:
        if standing is None and self._desk.workspace.session is not None:
            return Missing("", self.tr("The session is being read."), "", "")
        is_container = standing.is_container if standing is not None else None
        return missing_for_a_pour(self._desk.workspace, is_container)

    def _what_happened(self, step: Step) -> str:
        """Why the run was stopped, and what the arm itself says now."""
        status = self._course.situation.status
        problem = status.problem if status is not None and step is Step.STOPPED else ""
        stopped = self._course.stopped
        state = status.state if status is not None else None
        knows_more = state is not None and unreadiness(state.safety_mode, state.robot_mode) is not None
        if stopped and not knows_more:
            return stopped
        return " ".join(dict.fromkeys(filter(None, (stopped, problem))))

    def _ask(self, folder: Path, standing: Standing | None) -> None:
        """Ask for a run's outcome; what somebody has entered meanwhile stays."""
        outcome = self._side.outcome
        if self._course.doing is Doing.COUNTING:
            outcome.show_counting()
            self._asked = None
            return
        runs = standing.runs if standing is not None else ()
        run = next((one for one in runs if one.folder == folder), None)
        if self._asked != (folder, run):
            self._asked = folder, run
            known = run.outcome.n_candies if run is not None and run.outcome is not None else None
            outcome.show_run(run, known or self._course.cup.n_candies, self._course.failure)

    def _primary_text(self, step: Step) -> str:
        texts = {
            Step.EMPTY: self.missing.button if self.missing is not None else "",
            Step.CONNECT: self.tr("Connect"),
            Step.PLAN: self.tr("Plan"),
            Step.STOPPED: self.tr("Make the arm ready"),
            Step.WAY_BACK: self.tr("Show the way back"),
            Step.OUTCOME: self.tr("Save"),
        }
        return texts.get(step, "")
