"""The Robot page: connect, plan, check, hold to pour, and what became of the candies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.page import SplitView
from app.gui.pages.robot.candies import load_imagined_or_true
from app.gui.pages.robot.loading import SessionPours, load_cell, load_object, load_session_pours
from app.gui.pages.robot.procedure import PourProcedure
from app.gui.pages.robot.side import RobotSide
from app.gui.pages.robot.steps import Activity, Missing, Step, missing_for_a_pour
from app.gui.pages.robot.view import ArmView
from app.jobs.arm_events import MoveProgress
from core.session.pour_runs import PourRun, unfinished_run, write_outcome
from hardware.modes import unreadiness

_UPDATE_MS = 500
"""A plan expires, and a silent arm is noticed, without anything else happening."""


@dataclass(frozen=True, eq=False)
class _PoursKey:
    """Runs are added without a new stage: read at every refresh."""

    folder: Path


class RobotPage(BackgroundPage[_PoursKey, SessionPours]):
    """One thing at a time; nothing moves but by a button that is held.

    Attributes:
        procedure: what is done with the arm.
        view: the cell in 3D.
        side: the steps.
        missing: what the session still needs; none if a pour can be planned.
    """

    KEY = "robot"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, lambda key: load_session_pours(key.folder))
        self.procedure = PourProcedure(desk, self)
        self.view = ArmView()
        self.side = RobotSide()
        self.missing: Missing | None = None
        self._shown_step: Step | None = None
        self._asked: tuple[Path, PourRun | None] | None = None
        self._is_to_prepare = False
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(SplitView(self.view, self.side))
        self._clock = QTimer(self, interval=_UPDATE_MS)
        self._clock.timeout.connect(self.update_actions)
        self._clock.start()
        self._connect()
        self._show()
        self._show_arm()

    def _connect(self) -> None:
        procedure, side = self.procedure, self.side
        procedure.changed.connect(self._show)
        procedure.moved.connect(self._follow)
        procedure.run_ended.connect(lambda _: self.refresh())
        side.primary.clicked.connect(self._do_primary)
        side.again.clicked.connect(self._do_again)
        side.start.emptied.connect(procedure.restart_cups)
        side.hold_to_pour.confirmed.connect(procedure.pour)
        side.hold_to_back_off.confirmed.connect(procedure.back_off)
        side.check.ticked.connect(self.update_actions)
        side.outcome.edited.connect(self.update_actions)
        side.outcome.report_wanted.connect(self.desk.report_wanted)
        side.outcome.object_wanted.connect(self.desk.new_session_wanted)
        side.recovery.by_hand.connect(procedure.connect_arm)
        side.state.disconnect_requested.connect(procedure.disconnect_arm)
        side.state.gripper_requested.connect(procedure.move_gripper)
        side.runs.chosen.connect(self._choose_run)
        self.desk.arm.changed.connect(self._show_arm)

    # What is read

    @override
    def content_key(self) -> _PoursKey | None:
        return None if self.folder is None else _PoursKey(self.folder)

    @override
    def refresh(self) -> None:
        super().refresh()
        cell, workspace = self.desk.cell.settings, self.desk.workspace
        if cell is not None:
            key = cell, workspace.parameters.pouring.cup
            self.load("cell", key, lambda key: load_cell(*key), self.view.show_cell)
        record = workspace.record("reconstruction")
        if self.folder is None or record is None:
            self.load("object", None, load_object, self.view.show_object)
            self.view.show_object(None)
        else:
            surface = self.folder, record.digest
            self.load("object", surface, lambda key: load_object(key[0]), self.view.show_object)
        self._show()
        self._show_arm()

    @override
    def forget(self) -> None:
        self.procedure.forget_session()
        super().forget()

    @override
    def show_content(self, former: SessionPours | None) -> None:
        pours, planned = self.content, self.procedure.planned
        self.side.runs.show_runs(() if pours is None else pours.runs)
        chosen = None if pours is None else pours.chosen
        if planned is not None and chosen not in (None, (planned.plan.i, planned.plan.j)):
            self.procedure.discard_plan()
        self._show()
        if self._is_to_prepare and pours is not None:
            self._is_to_prepare = False
            self.procedure.prepare()

    # What a person does

    @override
    def press_primary(self) -> None:
        """Connect and plan, as soon as it is known whether there is something to pour."""
        if self.procedure.step is Step.OUTCOME and self.side.outcome.is_complete and self.desk.jobs.is_idle:
            self._do_again()
            return
        self._is_to_prepare = self.content is None
        if not self._is_to_prepare:
            self.procedure.prepare()

    def _do_primary(self) -> None:
        procedure, step = self.procedure, self.procedure.step
        if step is Step.EMPTY and self.missing is not None:
            self.desk.page_wanted.emit(self.missing.page)
        elif step is Step.OUTCOME:
            self._save_outcome()
        else:
            does = {
                Step.CONNECT: procedure.connect_arm,
                Step.PLAN: procedure.plan,
                Step.STOPPED: procedure.recover,
                Step.PLAN_BACK_OFF: procedure.plan_back_off,
            }
            if step in does:
                does[step]()

    def _do_again(self) -> None:
        """Plan anew; an outcome that was entered is saved."""
        if self.procedure.step is Step.OUTCOME and self.side.outcome.is_complete:
            self._save_outcome(self._plan_again)
        else:
            self._plan_again()

    def _plan_again(self) -> None:
        self.procedure.select_run(None)
        if self.procedure.step in (Step.PLAN, Step.CHECK):
            self.procedure.plan()

    def _choose_run(self, run: Path) -> None:
        if not self.procedure.step.is_moving and not self.procedure.step.is_recovery:
            self.procedure.select_run(run)

    def _save_outcome(self, then: Callable[[], None] | None = None) -> None:
        run, outcome = self.procedure.run, self.side.outcome.outcome
        if run is None:
            return

        def saved(_: None) -> None:
            self.procedure.select_run(None)
            self.desk.workspace.refresh()
            if then is not None:
                then()

        self.desk.background.run("robot.outcome", partial(write_outcome, run, outcome), saved, self.report)

    # What is shown

    def _follow(self, progress: MoveProgress) -> None:
        motion = self.procedure.motion
        if motion is not None:
            self.side.live.follow(progress, motion)
            if self.isVisible():
                self.view.follow(progress.done_s)

    def _show_arm(self) -> None:
        """Show what the arm reports."""
        arm = self.desk.arm
        is_ours, status = arm.is_ours_to_pour, arm.status
        self.side.state.setVisible(is_ours)
        if is_ours and arm.connected is not None:
            self.side.state.show_state(arm.connected, status, arm.has_stop_line, arm.is_silent)
        if not self.isVisible():
            return
        if not is_ours or status is None:
            last_seen_rad = None if arm.connected is not None else arm.last_seen_rad
            self.view.show_arm(None, holds_cup=False, last_seen_rad=last_seen_rad)
        elif status.state is not None:
            is_under_way = self.procedure.step.is_moving or status.must_back_off
            at_rest = None if status.is_gripper_closed else False  # closed by whom, around what?
            holds_cup = bool(status.is_gripper_closed) if is_under_way else at_rest
            self.view.show_arm(status.state.joints_rad, holds_cup)

    def _show(self) -> None:
        """Show the step that comes next, and what is planned."""
        procedure, side = self.procedure, self.side
        self.missing = self._missing()
        procedure.can_pour = self.missing is None
        step = procedure.step
        if step.is_moving and step is not self._shown_step:
            side.live.begin(step is Step.BACK_OFF)
        if step is not Step.OUTCOME:
            self._asked = None
        self._shown_step = step
        side.show_step(step)
        self._fill(step)
        side.runs.select(procedure.run)
        self.view.show_motion(procedure.motion)
        self._load_candies()
        if not step.is_moving:
            self.view.follow(None)
        self.update_actions()

    def _load_candies(self) -> None:
        """Those of the planned pour as imagined; else of the run that is asked for, as they were counted."""
        procedure, folder = self.procedure, self.folder
        planned, run = procedure.planned, procedure.run
        record = self.desk.workspace.record("pouring")
        is_counted = run is not None and procedure.activity is not Activity.COUNTING
        if folder is None or not (planned or is_counted):
            self.load("candies", None, load_imagined_or_true, self.view.show_candies)
            self.view.show_candies(None)
            return
        plan = None if planned is None else (planned.plan.i, planned.plan.j)
        key = folder, plan, run if planned is None else None, None if record is None else record.digest
        self.load("candies", key, load_imagined_or_true, self.view.show_candies)

    def _fill(self, step: Step) -> None:
        procedure, side, cell = self.procedure, self.side, self.desk.cell
        status = procedure.situation.status
        if step is Step.EMPTY and self.missing is not None:
            side.start.show_missing(self.missing.heading, self.missing.text)
        elif step is Step.CONNECT:
            side.start.show_connect(cell.settings, self.desk.arm.farewell, procedure.failure)
        elif step is Step.PLAN:
            failure = procedure.failure or procedure.stopped
            is_closed = self._is_gripper_closed
            if self._has_way_back:
                side.start.show_way_back(failure)
            else:
                side.start.show_plan(is_closed, procedure.has_backed_off, failure, procedure.cup)
            if is_closed:
                side.state.unfold()
        elif step is Step.CHECK and procedure.planned is not None:
            side.check.show_plan(procedure.planned, procedure.cup, is_rehearsal=cell.is_simulated)
        elif step.is_recovery and status is not None:
            what = self._what_happened(step)
            side.recovery.show_step(step, what, status.must_back_off, procedure.failure)
        elif step is Step.OUTCOME and procedure.run is not None:
            self._ask(procedure.run)

    @override
    def update_actions(self) -> None:
        procedure, side = self.procedure, self.side
        step, is_idle = procedure.step, self.desk.jobs.is_idle
        side.primary.setText(self._primary_text(step))
        side.primary.setVisible(bool(side.primary.text()))
        is_ready = is_idle or step is Step.EMPTY
        if step is Step.CONNECT:
            is_ready = is_ready and self.desk.cell.settings is not None
        if step is Step.PLAN:
            is_ready = is_ready and (self._has_way_back or not self._is_gripper_closed)
        if step is Step.OUTCOME:
            is_ready = is_ready and side.outcome.is_complete
        side.primary.setEnabled(is_ready)
        side.again.setEnabled(is_idle)
        side.again.setText(self.tr("Plan again") if step is Step.CHECK else self.tr("Pour again"))
        busy = None if is_idle else self.tr("Another job is running.")
        side.hold_to_back_off.set_blocked(busy)
        if procedure.planned is not None and step is Step.CHECK:
            side.check.update_expiry(procedure.planned)
            side.hold_to_pour.set_blocked(busy or side.check.reason(procedure.planned) or None)
        side.state.allow(
            disconnecting=is_idle and step in (Step.EMPTY, Step.PLAN, Step.OUTCOME),
            gripping=is_idle and step is Step.PLAN and procedure.situation.status is not None,
        )

    @property
    def _is_gripper_closed(self) -> bool:
        status = self.procedure.situation.status
        return status is not None and bool(status.is_gripper_closed)

    @property
    def _has_way_back(self) -> bool:
        """Whether a pour was not finished and its cup may still be in the hand: an earlier program's."""
        runs = () if self.content is None else self.content.runs
        return self._is_gripper_closed and unfinished_run(runs) is not None

    def _missing(self) -> Missing | None:
        if self.content is None and self.failure:
            return Missing(self.tr("The session cannot be read"), self.failure)
        if self.content is None and self.desk.workspace.session is not None:
            return Missing("", self.tr("Loading the session …"))
        is_container = None if self.content is None else self.content.is_container
        return missing_for_a_pour(self.desk.workspace, is_container)

    def _what_happened(self, step: Step) -> str:
        """Why the run was stopped, and what the arm itself reports now."""
        status, stopped = self.procedure.situation.status, self.procedure.stopped
        problem = status.problem if status is not None and step is Step.STOPPED else ""
        state = status.state if status is not None else None
        knows_more = state is not None and unreadiness(state.safety_mode, state.robot_mode) is not None
        if stopped and not knows_more:
            return stopped
        return " ".join(dict.fromkeys(filter(None, (stopped, problem))))

    def _ask(self, folder: Path) -> None:
        """Ask for a run's outcome; what somebody has entered meanwhile stays."""
        outcome, procedure = self.side.outcome, self.procedure
        if procedure.activity is Activity.COUNTING:
            outcome.show_counting()
            self._asked = None
            return
        runs = () if self.content is None else self.content.runs
        run = next((one for one in runs if one.folder == folder), None)
        if self._asked != (folder, run):
            self._asked = folder, run
            outcome.call_object(self.desk.workspace.session_name)
            known = None if run is None or run.outcome is None else run.outcome.n_candies
            outcome.show_run(run, known or procedure.cup.n_candies, procedure.failure)

    def _primary_text(self, step: Step) -> str:
        pending = self.procedure.pending
        if step in (Step.CONNECT, Step.STOPPED) and pending is not None:
            return pending.step.value.capitalize()
        texts = {
            Step.EMPTY: "" if self.missing is None else self.missing.button,
            Step.CONNECT: self.tr("Connect"),
            Step.PLAN: self.tr("Find the way back") if self._has_way_back else self.tr("Plan"),
            Step.STOPPED: self.tr("Make the arm ready"),
            Step.PLAN_BACK_OFF: self.tr("Plan the return"),
            Step.OUTCOME: self.tr("Save"),
        }
        return texts.get(step, "")
