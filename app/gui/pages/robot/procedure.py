"""The procedure with the arm, from connecting to the outcome: starts the jobs and keeps their results."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.robot.motion import ShownMotion
from app.gui.pages.robot.steps import Activity, Situation, Step
from app.gui.remedies import worded
from app.jobs.arm_events import MoveProgress, PlannedBackOff, PlannedPour, StepPending
from app.jobs.arm_work import ArmWork
from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind
from app.jobs.session_work import SessionWork
from app.operations.session import SessionTask
from core.errors import SessionError
from core.session.cups import Cup, cup_of_run, next_cup
from core.session.pour_runs import note_emptied

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

PAGE = "robot"
_BRIEF_S, _STOPPING_S, _RECOVERING_S = 3.0, 10.0, 60.0
"""How long a cancelled job may take: one that moves has to stop the arm, and a process that is ended while it
makes the arm ready forgets the path back."""
_SETTLING = (Activity.POURING, Activity.BACKING_OFF, Activity.RECOVERING)
"""After these the arm's next status decides what comes next."""


class PourProcedure(QObject):
    """From connecting to the outcome, and back after a stop.

    Signals: `changed` when the step or anything that belongs to it did; `moved` with each `MoveProgress`;
    `run_ended` with a run's folder when its outcome can be entered.

    Attributes:
        planned: the pour that was planned and is shown; none if none is.
        planned_back_off: the return after a stop, the same.
        pending: what has to be done before the arm can be connected or made ready; none if that is not known.
        run: whose outcome is asked for; none if none is.
        failure: why the last job failed, in a sentence; empty if it did not.
        stopped: why the arm was stopped the last time, until it has come back.
        can_pour: whether the session holds a pour to be made.
        has_backed_off: whether the arm has come back after a stop, and nothing was planned since.
        activity: the job under way.
    """

    changed = Signal()
    moved = Signal(object)
    run_ended = Signal(object)

    def __init__(self, desk: Desk, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.planned: PlannedPour | None = None
        self.pending: StepPending | None = None
        self.planned_back_off: PlannedBackOff | None = None
        self.run: Path | None = None
        self.failure = self.stopped = ""
        self.has_backed_off = self.can_pour = False
        self.activity = Activity.NONE
        self._desk = desk
        self._cell: CellSettings | None = None
        self._task: SessionTask | None = None
        self._motion: ShownMotion | None = None
        self._is_settling = False
        self._seen: object = None
        desk.arm.changed.connect(self._follow_arm)
        desk.jobs.event_received.connect(self._hear)
        desk.jobs.finished.connect(self._end)
        desk.jobs.failed.connect(self._fail)

    @property
    def situation(self) -> Situation:
        """Everything that the next step depends on."""
        arm = self._desk.arm
        is_ours = arm.is_ours_to_pour
        return Situation(
            self.activity,
            arm.status if is_ours else None,
            is_ours and self._cell == self._desk.cell.settings,
            self.can_pour,
            self.planned is not None,
            self.planned_back_off is not None,
            self.run is not None,
        )

    @property
    def step(self) -> Step:
        """What comes next."""
        return self.situation.step

    @property
    def motion(self) -> ShownMotion | None:
        """What is planned, as it is shown; none if nothing is."""
        return None if self.planned is None and self.planned_back_off is None else self._motion

    @property
    def cup(self) -> Cup:
        """Which cup the outcome is asked for, or comes next, and how many candies were imagined in it."""
        workspace = self._desk.workspace
        session, n_pour = workspace.session, workspace.parameters.pouring.n_pour
        if session is None:
            return Cup(1, 1, n_pour, None)
        pours = workspace.pours
        cups = (n_pour,) if pours is None else pours.n_per_cup
        if self.run is not None:
            return cup_of_run(session.path, self.run, cups)
        return next_cup(session.path, "" if pours is None else pours.digest, cups)

    # What a person asks for

    def prepare(self) -> None:
        """Connect the arm if none is, and plan; nothing moves."""
        if self.step is Step.CONNECT and self.pending is None:
            self._connect_arm(then=lambda _: self.plan())
        elif self.step is Step.PLAN:
            self.plan()

    def connect_arm(self) -> None:
        """Connect the cell's arm; nothing moves."""
        self._connect_arm(then=None)

    def _connect_arm(self, then: Callable[[Any], None] | None) -> None:
        cell = self._desk.cell.settings
        if cell is not None:
            pending, self.pending = self.pending, None
            step = None if pending is None or cell != self._cell else pending.step
            self._cell = cell
            title = self.tr("Connect the arm")
            self._start(Activity.CONNECTING, title, ArmWork.connect, cell, step, then=then)

    def disconnect_arm(self) -> None:
        """Let the arm go."""
        self._start(Activity.CONNECTING, self.tr("Disconnect the arm"), ArmWork.disconnect)

    def plan(self) -> None:
        """Plan the chosen pour from where the arm is; nothing moves.

        Which pours the arm can make is checked before, in the session's process, if that is not known yet: it
        takes all processors for some seconds.
        """
        cell, workspace = self._desk.cell.settings, self._desk.workspace
        if cell is None or workspace.session is None or not self._desk.jobs.is_idle:
            return
        self.planned = None
        task = self._task = workspace.task()

        def plan(_: object) -> None:
            title = self.tr("Plan the pour")
            self._start(Activity.PLANNING, title, ArmWork.plan, task, cell, then=self._take_plan)

        self._start(
            Activity.PLANNING,
            self.tr("Check which pours the arm can make"),
            SessionWork.judge_motions,
            task,
            cell,
            host=self._desk.session_host,
            then=plan,
        )

    def pour(self) -> None:
        """Make the pour that is shown; called when somebody has held the button."""
        if self.planned is not None:
            self._move(Activity.POURING, self.tr("Pour"), ArmWork.pour, self.planned.number, self._take_run)

    def recover(self) -> None:
        """Make the arm accept moves again; it does not move."""
        title = self.tr("Make the arm ready")
        pending, self.pending = self.pending, None
        step = None if pending is None else pending.step
        self._start(
            Activity.RECOVERING, title, ArmWork.recover, step, then=self._take_ready, patience_s=_RECOVERING_S
        )

    def plan_back_off(self) -> None:
        """Plan the return after a stop; nothing moves."""
        if self._task is not None:
            title, work = self.tr("Plan the return"), ArmWork.plan_back_off
            self._start(Activity.PLANNING_BACK_OFF, title, work, self._task, then=self._take_back_off)

    def back_off(self) -> None:
        """Make the return that is shown; called when somebody has held the button."""
        if self.planned_back_off is not None:
            number = self.planned_back_off.number
            self._move(Activity.BACKING_OFF, self.tr("Back off"), ArmWork.back_off, number, self._take_return)

    def move_gripper(self, is_closing: bool) -> None:
        """Close or open the gripper; called when somebody has held the button."""
        title = self.tr("Close the gripper") if is_closing else self.tr("Open the gripper")
        self.planned = None
        self._start(Activity.GRIPPING, title, ArmWork.move_gripper, is_closing, time.monotonic())

    def select_run(self, run: Path | None) -> None:
        """Ask for a run's outcome; none: for none any more."""
        self.run = run
        self.changed.emit()

    def restart_cups(self) -> None:
        """Record that the object was emptied, so that the first cup comes next."""
        session = self._desk.workspace.session
        if session is None:
            return
        try:
            note_emptied(session.path)
        except SessionError as error:
            self.failure = worded(error)
        self.changed.emit()

    def discard_plan(self) -> None:
        """Forget what was planned: it is not what would be poured now."""
        if self.planned is not None and not self.step.is_moving:
            self.planned = None
            self.changed.emit()

    def forget_session(self) -> None:
        """Another session was opened; what the arm has to come back from stays."""
        self.planned = self.run = None
        self.has_backed_off = False
        self.failure = ""
        self.changed.emit()

    # Jobs and their results

    def _start(
        self,
        activity: Activity,
        title: str,
        method: Callable[..., Any],
        *arguments: Any,
        host: Host[Any] | None = None,
        then: Callable[[Any], None] | None = None,
        patience_s: float = _BRIEF_S,
    ) -> None:
        """Begin a job of the process that pours, or of `host`."""
        jobs = self._desk.jobs
        if not jobs.is_idle:
            return
        self.activity, self.failure = activity, ""
        host = host or self._desk.arm_host
        jobs.start(title, PAGE, host, method, *arguments, then=then, patience_s=patience_s)
        self.changed.emit()

    def _move(
        self,
        activity: Activity,
        title: str,
        method: Callable[..., Any],
        number: int,
        then: Callable[[Any], None],
    ) -> None:
        """Carry out a plan by its number; how long ago it was confirmed is checked where it is done."""
        self._start(activity, title, method, number, time.monotonic(), then=then, patience_s=_STOPPING_S)

    def _take_plan(self, planned: PlannedPour) -> None:
        self.planned, self.has_backed_off, self.stopped = planned, False, ""
        self._motion = ShownMotion(planned)
        self.changed.emit()

    def _take_ready(self, _: None) -> None:
        status = self._desk.arm.status
        if status is None or not status.must_back_off:
            self.stopped = ""

    def _take_back_off(self, planned: PlannedBackOff) -> None:
        self.planned_back_off, self._motion = planned, ShownMotion(planned)
        self.changed.emit()

    def _take_run(self, run: Path) -> None:
        """A pour was made: in the simulated cell physics gives the outcome, at a real table a person does."""
        self.planned, self.run, self.activity = None, run, Activity.NONE
        task, cell = self._task, self._cell
        if task is not None and cell is not None and cell.has_simulated_object:
            title, work, host = (
                self.tr("Count the spilled candies"),
                SessionWork.simulate_outcome,
                self._desk.session_host,
            )
            self._start(Activity.COUNTING, title, work, task, cell, run, host=host)
        else:
            self.run_ended.emit(run)
            self.changed.emit()

    def _take_return(self, _run: Path) -> None:
        self.planned_back_off, self.has_backed_off, self.stopped = None, True, ""
        self.changed.emit()

    def _hear(self, news: object) -> None:
        if isinstance(news, MoveProgress):
            self.moved.emit(news)
        elif isinstance(news, StepPending):
            self.pending = news

    def _follow_arm(self) -> None:
        """An arm that is gone or was stopped takes its plans with it."""
        if self._is_settling:
            self._is_settling, self.activity = False, Activity.NONE
        step = self.step
        if not step.is_moving:
            if not self.situation.is_connected or step.is_recovery:
                self.planned = None
            if step not in (Step.PLAN_BACK_OFF, Step.CHECK_BACK_OFF):
                self.planned_back_off = None
        arm, status = self._desk.arm, self._desk.arm.status
        said = None if status is None else (status.problem, status.must_back_off, status.is_gripper_closed)
        seen = (self.step, self.situation.is_connected, arm.farewell, said)
        if seen != self._seen:
            self._seen = seen
            self.changed.emit()

    def _end(self, job: RunningJob, _result: object) -> None:
        if job.page != PAGE:
            return
        if self.activity is Activity.COUNTING and self.run is not None:
            self.run_ended.emit(self.run)
        if self.activity is not Activity.POURING:  # its run decides
            self._settle()
        self.changed.emit()

    def _fail(self, job: RunningJob, failed: Failed) -> None:
        if job.page != PAGE:
            return
        if self.activity is Activity.COUNTING and self.run is not None:
            self.run_ended.emit(self.run)  # then a person has to say
        if self.activity in (Activity.POURING, Activity.BACKING_OFF):
            self.planned = self.planned_back_off = None  # a plan is carried out once at most
            self.stopped = failed.sentence
        elif failed.kind is not FailureKind.CANCELLED:
            self.failure = failed.sentence if self.pending is None else self.pending.sentence
        self._settle()
        self.changed.emit()

    def _settle(self) -> None:
        """The job is over; where it moved the arm, the arm's next status decides what comes next."""
        self._is_settling = self.activity in _SETTLING and self._desk.arm.is_ours_to_pour
        if not self._is_settling:
            self.activity = Activity.NONE
