"""What is done with the arm, one thing after the other: starts the jobs and keeps what they gave."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.robot.motion import ShownMotion
from app.gui.pages.robot.steps import Doing, Situation, Step
from app.jobs.arm_news import MoveProgress, PlannedBackOff, PlannedPour
from app.jobs.arm_work import ArmWork
from app.jobs.messages import Failed, FailureKind
from app.jobs.session_work import SessionTask, SessionWork
from core.errors import SessionError
from core.imagination.amount.result import imagined_cups
from core.session.cups import Cup, cup_of_run, next_cup
from core.session.pour_runs import note_emptied

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

PAGE = "robot"
_BRIEF_S, _STOPPING_S, _RECOVERING_S = 3.0, 10.0, 60.0
"""How long a cancelled job may take: one that moves has to bring the arm to a stand, and a process that is
ended while it makes the arm ready forgets the way back."""
_SETTLING = (Doing.POURING, Doing.BACKING, Doing.RECOVERING)
"""After these the arm's next word tells what comes next."""


class Course(QObject):
    """From connecting to the outcome, and back after a stop.

    Signals: `changed` when the step or anything that belongs to it did; `moved` with each `MoveProgress`;
    `run_ended` with a run's folder when its outcome can be entered.

    Attributes:
        planned: the pour that was planned and is shown; none if none is.
        way: the way back, the same.
        run: whose outcome is asked for; none if none is.
        progress: of the move under way; none before the first.
        failure: why the last job failed, in a sentence; empty if it did not.
        stopped: why the arm was stopped the last time, until it has come back.
        is_possible: whether the session holds a pour to be made.
        has_backed_off: whether the arm has come back after a stop, and nothing was planned since.
    """

    changed = Signal()
    moved = Signal(object)
    run_ended = Signal(object)

    def __init__(self, desk: Desk, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.planned: PlannedPour | None = None
        self.way: PlannedBackOff | None = None
        self.run: Path | None = None
        self.progress: MoveProgress | None = None
        self.failure = self.stopped = ""
        self.has_backed_off = False
        self.is_possible = False
        self._desk = desk
        self._doing = Doing.NOTHING
        self._cell: CellSettings | None = None
        self._task: SessionTask | None = None
        self._motion: ShownMotion | None = None
        self._is_settling = False
        self._seen: object = None
        desk.arm.changed.connect(self._look_at_arm)
        desk.jobs.news.connect(self._hear)
        desk.jobs.finished.connect(self._end)
        desk.jobs.failed.connect(self._fail)

    @property
    def situation(self) -> Situation:
        """How everything stands."""
        arm = self._desk.arm
        is_ours = arm.is_ours_to_pour
        return Situation(
            self._doing,
            arm.status if is_ours else None,
            is_ours and self._cell == self._desk.cell.settings,
            self.is_possible,
            self.planned is not None,
            self.way is not None,
            self.run is not None,
        )

    @property
    def motion(self) -> ShownMotion | None:
        """What is planned, as it is shown; none if nothing is."""
        return None if self.planned is None and self.way is None else self._motion

    @property
    def cup(self) -> Cup:
        """Which cup is asked about, or comes next, and how many candies its imagination reckoned with."""
        workspace = self._desk.workspace
        session, n_pour = workspace.session, workspace.parameters.pouring.n_pour
        if session is None:
            return Cup(1, 1, n_pour, None)
        cups = imagined_cups(session.path / "pouring") or (n_pour,)
        if self.run is not None:
            return cup_of_run(session.path, self.run, cups)
        record = session.record("pouring")
        return next_cup(session.path, "" if record is None else record.digest, cups)

    @property
    def step(self) -> Step:
        """What comes next."""
        return self.situation.step

    @property
    def doing(self) -> Doing:
        """The job under way."""
        return self._doing

    def connect_arm(self) -> None:
        """Connect the cell's arm; nothing moves."""
        self._connect_arm(None)

    def get_ready(self) -> None:
        """Connect the arm if none is, and plan; nothing moves."""
        if self.step is Step.CONNECT:
            self._connect_arm(lambda _: self.plan())
        elif self.step is Step.PLAN:
            self.plan()

    def _connect_arm(self, then: Callable[[Any], None] | None) -> None:
        cell = self._desk.cell.settings
        if cell is not None:
            self._cell = cell
            self._start(Doing.CONNECTING, self.tr("Connect the arm"), ArmWork.connect, cell, then=then)

    def disconnect_arm(self) -> None:
        """Let the arm go."""
        self._start(Doing.CONNECTING, self.tr("Disconnect the arm"), ArmWork.disconnect)

    def plan(self) -> None:
        """Plan the chosen pour from where the arm stands; nothing moves.

        Which pours the arm can make is judged before, in the session's process, if nobody has yet: it takes
        all processors for some seconds.
        """
        cell, desk = self._desk.cell.settings, self._desk
        if cell is None or desk.workspace.session is None or not desk.jobs.is_idle:
            return
        self.planned = None
        task = self._task = desk.workspace.task()

        def plan(_: object) -> None:
            self._start(
                Doing.PLANNING, self.tr("Plan the pour"), ArmWork.plan, task, cell, then=self._take_plan
            )

        self._doing, self.failure = Doing.PLANNING, ""
        judge = SessionWork.judge_motions
        desk.jobs.start(self.tr("Judge the pours"), PAGE, desk.session_host, judge, task, cell, then=plan)
        self.changed.emit()

    def pour(self) -> None:
        """Make the pour that is shown; called when somebody has held the button."""
        if self.planned is not None:
            number = self.planned.number
            self._start(
                Doing.POURING,
                self.tr("Pour"),
                ArmWork.pour,
                number,
                time.monotonic(),
                then=self._take_run,
                patience_s=_STOPPING_S,
            )

    def recover(self) -> None:
        """Make the arm take moves again; it does not move."""
        self._start(
            Doing.RECOVERING,
            self.tr("Make the arm ready"),
            ArmWork.recover,
            then=self._take_ready,
            patience_s=_RECOVERING_S,
        )

    def plan_way_back(self) -> None:
        """Plan the way back after a stop; nothing moves."""
        if self._task is not None:
            self._start(
                Doing.PLANNING_BACK,
                self.tr("Plan the way back"),
                ArmWork.plan_back_off,
                self._task,
                then=self._take_way,
            )

    def back_off(self) -> None:
        """Make the way back that is shown; called when somebody has held the button."""
        if self.way is not None:
            number = self.way.number
            self._start(
                Doing.BACKING,
                self.tr("Back off"),
                ArmWork.back_off,
                number,
                time.monotonic(),
                then=self._take_return,
                patience_s=_STOPPING_S,
            )

    def move_gripper(self, is_closing: bool) -> None:
        """Close or open the gripper; called when somebody has held the button."""
        title = self.tr("Close the gripper") if is_closing else self.tr("Open the gripper")
        self.planned = None
        self._start(Doing.GRIPPING, title, ArmWork.move_gripper, is_closing, time.monotonic())

    def ask_outcome(self, run: Path | None) -> None:
        """Ask for a run's outcome; none: for none any more."""
        self.run = run
        self.changed.emit()

    def begin_with_first_cup(self) -> None:
        """Keep that the object was emptied, so that the first cup comes next."""
        session = self._desk.workspace.session
        if session is None:
            return
        try:
            note_emptied(session.path)
        except SessionError as error:
            self.failure = str(error)
        self.changed.emit()

    def drop_plan(self) -> None:
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

    def _start(
        self,
        doing: Doing,
        title: str,
        method: Callable[..., Any],
        *arguments: Any,
        then: Callable[[Any], None] | None = None,
        patience_s: float = _BRIEF_S,
    ) -> None:
        jobs = self._desk.jobs
        if not jobs.is_idle:
            return
        self._doing = doing
        self.failure, self.progress = "", None
        jobs.start(title, PAGE, self._desk.arm_host, method, *arguments, then=then, patience_s=patience_s)
        self.changed.emit()

    def _take_plan(self, planned: PlannedPour) -> None:
        self.planned, self.has_backed_off, self.stopped = planned, False, ""
        self._motion = ShownMotion.of_pour(planned)
        self.changed.emit()

    def _take_ready(self, _: None) -> None:
        status = self._desk.arm.status
        if status is None or not status.must_back_off:
            self.stopped = ""

    def _take_way(self, way: PlannedBackOff) -> None:
        self.way, self._motion = way, ShownMotion.of_way_back(way)
        self.changed.emit()

    def _take_run(self, run: Path) -> None:
        """A pour was made: in the simulated cell physics tells the outcome, at a real table a person does."""
        self.planned, self.run, self._doing = None, run, Doing.NOTHING
        task, cell = self._task, self._cell
        if task is not None and cell is not None and cell.is_simulated:
            self._doing = Doing.COUNTING
            self._desk.jobs.start(
                self.tr("Count the spilled candies"),
                PAGE,
                self._desk.session_host,
                SessionWork.simulate_outcome,
                task,
                cell,
                run,
            )
        else:
            self.run_ended.emit(run)
        self.changed.emit()

    def _take_return(self, _run: Path) -> None:
        self.way, self.has_backed_off, self.stopped = None, True, ""
        self.changed.emit()

    def _hear(self, news: object) -> None:
        if isinstance(news, MoveProgress):
            self.progress = news
            self.moved.emit(news)

    def _look_at_arm(self) -> None:
        """An arm that is gone or was stopped takes its plans with it."""
        if self._is_settling:
            self._is_settling, self._doing = False, Doing.NOTHING
        step = self.step
        if not step.is_moving:
            if not self.situation.is_connected or step.is_recovery:
                self.planned = None
            if step not in (Step.WAY_BACK, Step.BACK):
                self.way = None
        arm, status = self._desk.arm, self._desk.arm.status
        said = None if status is None else (status.problem, status.must_back_off, status.is_gripper_closed)
        seen = (self.step, self.situation.is_connected, arm.farewell, said)
        if seen != self._seen:
            self._seen = seen
            self.changed.emit()

    def _end(self, job: RunningJob, _result: object) -> None:
        if job.page != PAGE:
            return
        if self._doing is Doing.COUNTING and self.run is not None:
            self.run_ended.emit(self.run)
        if self._doing is not Doing.POURING:  # its run decides
            self._settle()
        self.changed.emit()

    def _fail(self, job: RunningJob, failed: Failed) -> None:
        if job.page != PAGE:
            return
        doing = self._doing
        if doing is Doing.COUNTING and self.run is not None:
            self.run_ended.emit(self.run)  # then a person has to say
        if doing in (Doing.POURING, Doing.BACKING):
            self.planned = self.way = None  # whatever was offered was taken
            self.stopped = failed.sentence
        elif failed.kind is not FailureKind.CANCELLED:
            self.failure = failed.sentence
        self._settle()
        self.changed.emit()

    def _settle(self) -> None:
        """The job is over; where the arm was in it, one waits for what it says now."""
        self._is_settling = self._doing in _SETTLING and self._desk.arm.is_ours_to_pour
        if not self._is_settling:
            self._doing = Doing.NOTHING
