"""The Robot page: connect, plan, check, hold to pour, and what became of the candies."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.page import Page, SplitView
from app.gui.pages.robot.course import Course
from app.gui.pages.robot.guide import Guide
from app.gui.pages.robot.loading import ShownCell, Standing, load_cell, load_object, load_standing
from app.gui.pages.robot.side_part import RobotSide
from app.gui.pages.robot.steps import Step
from app.gui.pages.robot.view_part import ArmView
from app.gui.views.scene import PreparedMesh
from app.jobs.arm_news import MoveProgress
from core.session.pour_runs import write_outcome

_LOOK_MS = 500


class RobotPage(Page):
    """One thing at a time; nothing moves but by a button that is held.

    Attributes:
        course: what is done with the arm.
        view: the cell in 3D.
        side: the steps.
    """

    KEY = "robot"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.course = Course(desk, self)
        self.view = ArmView()
        self.side = RobotSide()
        self._guide = Guide(desk, self.course, self.side)
        self._standing: Standing | None = None
        self._session: Path | None = None
        self._cell_key: object = None
        self._object_key: object = None
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(SplitView(self.view, self.side))
        self._is_to_get_ready = False
        self._clock = QTimer(self, interval=_LOOK_MS)
        self._clock.timeout.connect(self._guide.look)
        self._clock.start()
        self._connect()
        self._show()
        self._show_arm()

    def _connect(self) -> None:
        course, side, jobs = self.course, self.side, self.desk.jobs
        course.changed.connect(self._show)
        course.moved.connect(self._follow)
        course.run_ended.connect(lambda _: self._load_standing())
        side.primary.clicked.connect(self._do_primary)
        side.again.clicked.connect(self._do_again)
        side.start.emptied.connect(course.begin_with_first_cup)
        side.hold_to_pour.confirmed.connect(course.pour)
        side.hold_to_back_off.confirmed.connect(course.back_off)
        side.check.ticked.connect(self._guide.look)
        side.outcome.edited.connect(self._guide.look)
        side.recovery.by_hand.connect(course.connect_arm)
        side.state.leave_wanted.connect(course.disconnect_arm)
        side.state.gripper_wanted.connect(course.move_gripper)
        side.runs.chosen.connect(self._choose_run)
        self.desk.arm.changed.connect(self._show_arm)
        for signal in (jobs.started, jobs.finished, jobs.failed):
            signal.connect(self._guide.look)

    @override
    def refresh(self) -> None:
        """Load what is other than before; what is shown stays until it is there."""
        workspace = self.desk.workspace
        if workspace.folder != self._session:
            self._session, self._standing = workspace.folder, None
            self.side.runs.show_runs(())
            self.course.forget_session()
        self._load_cell()
        self._load_object()
        self._load_standing()
        self._show()
        self._show_arm()

    @override
    def press_primary(self) -> None:
        """Connect and plan, as soon as it is known whether there is something to pour."""
        self._is_to_get_ready = self._standing is None
        if not self._is_to_get_ready:
            self.course.get_ready()

    def _load_cell(self) -> None:
        cell, cup = self.desk.cell.settings, self.desk.workspace.parameters.pouring.cup
        if cell is not None and (cell, cup) != self._cell_key:
            self._cell_key = cell, cup
            self.desk.background.run("robot cell", partial(load_cell, cell, cup), self._take_cell)

    def _load_object(self) -> None:
        session = self.desk.workspace.session
        record = None if session is None else session.record("reconstruction")
        key = None if session is None or record is None else (session.path, record.digest)
        if key == self._object_key:
            return
        self._object_key = key
        if key is None:
            self.view.show_object(None)
        else:
            take = partial(self._take_object, key)
            self.desk.background.run("robot object", partial(load_object, key[0]), take)

    def _load_standing(self) -> None:
        folder = self.desk.workspace.folder
        if folder is not None:
            take = partial(self._take_standing, folder)
            self.desk.background.run("robot standing", partial(load_standing, folder), take)

    def _take_cell(self, cell: ShownCell) -> None:
        self.view.show_cell(cell)
        self._show_arm()

    def _take_object(self, key: object, mesh: PreparedMesh | None) -> None:
        if key == self._object_key:
            self.view.show_object(mesh)

    def _take_standing(self, folder: Path, standing: Standing) -> None:
        if folder != self.desk.workspace.folder:
            return
        self._standing = standing
        self.side.runs.show_runs(standing.runs)
        planned = self.course.planned
        if planned is not None and standing.chosen not in (None, (planned.plan.i, planned.plan.j)):
            self.course.drop_plan()
        self._show()
        if self._is_to_get_ready:
            self._is_to_get_ready = False
            self.course.get_ready()

    def _do_primary(self) -> None:
        course, step = self.course, self.course.step
        if step is Step.EMPTY and self._guide.missing is not None:
            self.desk.page_wanted.emit(self._guide.missing.page)
        elif step is Step.OUTCOME:
            self._save_outcome()
        else:
            does = {
                Step.CONNECT: course.connect_arm,
                Step.PLAN: course.plan,
                Step.STOPPED: course.recover,
                Step.WAY_BACK: course.plan_way_back,
            }
            if step in does:
                does[step]()

    def _do_again(self) -> None:
        """Plan anew; what was said of the candies is kept."""
        if self.course.step is Step.OUTCOME and self.side.outcome.is_complete:
            self._save_outcome(self._plan_again)
        else:
            self._plan_again()

    def _plan_again(self) -> None:
        self.course.ask_outcome(None)
        if self.course.step in (Step.PLAN, Step.CHECK):
            self.course.plan()

    def _choose_run(self, run: Path) -> None:
        if not self.course.step.is_moving and not self.course.step.is_recovery:
            self.course.ask_outcome(run)

    def _save_outcome(self, then: Callable[[], None] | None = None) -> None:
        run, outcome = self.course.run, self.side.outcome.outcome
        if run is None:
            return

        def saved(_: None) -> None:
            self.course.ask_outcome(None)
            self.desk.workspace.refresh()
            if then is not None:
                then()

        write = partial(write_outcome, run, outcome)
        self.desk.background.run("robot outcome", write, saved, lambda error: self.desk.told.emit(str(error)))

    def _follow(self, progress: MoveProgress) -> None:
        motion = self.course.motion
        if motion is not None:
            self.side.live.follow(progress, motion)
            if self.isVisible():
                self.view.follow(progress.done_s)

    def _show(self) -> None:
        """Show the step that comes next, and what is planned."""
        self._guide.show(self._standing)
        self.side.runs.select(self.course.run)
        self.view.show_motion(self.course.motion)
        if not self.course.step.is_moving:
            self.view.follow(None)

    def _show_arm(self) -> None:
        """Show what the arm says of itself."""
        arm = self.desk.arm
        is_ours, status = arm.is_ours_to_pour, arm.status
        self.side.state.setVisible(is_ours)
        if is_ours and arm.connected is not None:
            self.side.state.show_state(arm.connected, status, arm.has_stop_line, arm.is_silent)
        if not self.isVisible():
            return
        if not is_ours or status is None:
            self.view.show_arm(None, holds_cup=False)
        elif status.state is not None:
            is_under_way = self.course.step.is_moving or status.must_back_off
            at_rest = None if status.is_gripper_closed else False  # closed by whom, around what?
            holds_cup = bool(status.is_gripper_closed) if is_under_way else at_rest
            self.view.show_arm(status.state.joints_rad, holds_cup)
