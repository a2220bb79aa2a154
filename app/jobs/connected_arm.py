"""A connected arm in its host process: its status, what is planned for it, what refuses, and its progress."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from app.jobs.arm_events import (
    ArmConnected,
    ArmDisconnected,
    ArmStatus,
    MoveProgress,
    PlannedBackOff,
    PlannedPour,
)
from app.jobs.service import JobReporter
from app.operations.session import SessionTask
from core.errors import MotionError, StageError
from core.geometry import FloatArray, make_pose
from core.imagination.cup import pivot_in_cup_m
from core.motion.kinematics import flange_pose
from core.motion.pour.plan import Segment
from core.pipeline.freshness import Freshness, freshness
from core.pipeline.session_view import IMAGINED, SessionView
from core.progress import Reporter
from hardware.errors import RobotError, RobotLost, RobotNotReady
from hardware.modes import unreadiness

if TYPE_CHECKING:
    from app.operations.pouring import PreparedPour
    from core.motion.pour.cell import PourCell
    from core.motion.pour.plan import PlannedMove, PourTarget
    from core.pipeline.pipeline import Pipeline
    from hardware.cell.cell import Arm
    from hardware.interfaces import RobotState
    from hardware.pouring.pouring import FreshPlan, Pouring

CONFIRMED_FOR_S = 3.0
"""A confirmation that is older does not count: nothing moves at a moment when nobody expects it."""
_STATUS_S, _STATUS_MOVING_S = 0.1, 0.05
_AT_REST_RAD_S = 2e-3
_SHOWN_SAMPLES = 8
"""One in so many samples of a path is shown."""
_MIN_INTERVAL_S = 0.05
_MEASURED_SPEED_AFTER_S = 1.0
"""Before that, the arm is taken to move as planned."""

PivotOff = Callable[[str], float | None]
"""How far the pivot is from its place in a move of this name, in metres."""


class ConnectedArm:
    """An arm that was entered, and the thread that reports its status.

    Attributes:
        arm: robot and gripper.
        moves: reports what it does.
        pouring: what is done with it; none before the first plan.
        T_flange_cup: (4, 4) the cup in the hand, by the last plan.
        must_recover: whether it was stopped, and does not move until it is made ready again.
        is_at_work: whether a job moves it or makes it ready.
    """

    def __init__(self, arm: Arm, publish: Callable[[Any], None]) -> None:
        """Publish that it is connected, and from now on its status."""
        self.arm = arm
        self.moves = MoveReporter()
        self.pouring: Pouring | None = None
        self.T_flange_cup = np.eye(4)
        self.must_recover = False
        self.is_at_work = False
        self._publish = publish
        self._is_over = Event()
        address = arm.controller.address if arm.controller is not None else arm.settings.robot.address
        publish(ArmConnected(arm.robot.name, address, arm.controller is not None))
        self._thread = Thread(target=self._watch, name="arm status", daemon=True)
        self._thread.start()

    @property
    def stopped_in(self) -> Segment | None:
        """The move in which a run was stopped midway; none if none was."""
        move = None if self.pouring is None else self.pouring.interrupted_move
        return None if move is None else move.name

    @property
    def is_lost(self) -> bool:
        """Whether it was published to be disconnected."""
        return self._is_over.is_set()

    def disconnect(self) -> None:
        """Disconnect; what moves is stopped."""
        self._is_over.set()
        self._thread.join()
        self.arm.__exit__(None, None, None)

    def refuse_unready(self) -> None:
        """Refuse an arm that is not ready to move, or that was stopped midway.

        Raises:
            RobotError: what has to be done first.
            MotionError: it has to back off first.
        """
        problem = self._problem(self.arm.robot.state())
        if problem:
            raise RobotNotReady(problem)
        if self.stopped_in is not None:
            raise MotionError("The arm was stopped during a run; back off first.")

    def left_by_earlier_program(self, pouring: Pouring, cell: PourCell, known: str) -> MotionError:
        """Offer the way back of an earlier program's run; returns what to say about it."""
        plan = pouring.interrupted_plan
        assert plan is not None, "it was taken up"
        self.pouring = pouring
        self.T_flange_cup = cell.T_flange_grasp @ plan.T_grasp_cup
        return MotionError(
            f"The gripper is closed. {known} If the cup is in the hand, let the arm back off; if not, "
            "connect again, then open the gripper where it is and plan from there."
        )

    def refuse_moving(self) -> None:
        """Refuse an arm that is not at rest.

        Raises:
            RobotError: it moves.
        """
        if np.abs(self.arm.robot.state().joint_speeds_rad_s).max() > _AT_REST_RAD_S:
            raise RobotNotReady("The arm is moving; wait until it stops.")

    def _watch(self) -> None:
        while not self._is_over.wait(_STATUS_MOVING_S if self.is_at_work else _STATUS_S):
            try:
                self._publish(self._status())
            except RobotLost:
                self._is_over.set()
                self._publish(
                    ArmDisconnected(
                        f"The link to the {self.arm.robot.name} was lost, so its state is unknown; check "
                        "the arm and the network cable, then connect again."
                    )
                )

    def _status(self) -> ArmStatus:
        """The status now.

        Raises:
            RobotLost: it does not answer, and nobody is about to find out why: no job, nor who has to make it
                ready again, of which the driver may have let go meanwhile.
        """
        try:
            state = self.arm.robot.state()
            gripper = self.arm.gripper
            is_closed, is_holding, width_m = gripper.is_closed, gripper.is_holding, gripper.width_m
        except RobotError as error:
            is_looked_after = self.is_at_work or self.must_recover or self.stopped_in is not None
            if isinstance(error, RobotLost) and not is_looked_after:
                raise
            return ArmStatus(None, None, str(error), self.stopped_in)
        return ArmStatus(state, is_closed, self._problem(state), self.stopped_in, is_holding, width_m)

    def _problem(self, state: RobotState) -> str:
        unready = unreadiness(state.safety_mode, state.robot_mode)
        if unready is not None:
            return str(unready)
        if self.must_recover:
            return "The arm was stopped; make sure that all is well, then make it ready again."
        if not state.is_program_running:
            return "The arm's control program is not running any more; make the arm ready again."
        return ""


class MoveReporter(Reporter):
    """Reports moves, as they were planned, to the job that makes them."""

    def __init__(self) -> None:
        super().__init__()
        self._job: JobReporter | None = None
        self._names: list[str] = []
        self._durations_s: list[float] = []
        self._begins_s: list[float] = []
        self._pivot_off: PivotOff = lambda _: None
        self._began_s: float | None = None
        self._reported_s = 0.0

    def begin(self, job: JobReporter, moves: Sequence[PlannedMove], pivot_off: PivotOff) -> None:
        """Report these moves to a job from now on."""
        self._job, self._pivot_off = job, pivot_off
        self._names = [move.name for move in moves]
        self._durations_s = [move.trajectory.duration_s for move in moves]
        self._begins_s = [sum(self._durations_s[:k]) for k in range(len(moves))]
        self._began_s, self._reported_s = None, 0.0

    def progress(self, stage: str, done: float, total: float) -> None:
        """Report how many of the planned seconds are done, and of which move."""
        if self._job is None:
            return
        self._job.progress(stage, done, total)
        now_s = time.monotonic()
        # Not in `begin`: the plan is checked once more before the first move, whatever its speed.
        if self._began_s is None:
            self._began_s = now_s
        if now_s - self._reported_s < _MIN_INTERVAL_S:
            return
        self._reported_s = now_s
        k = max(bisect_right(self._begins_s, done + 1e-9) - 1, 0)
        fraction = min((done - self._begins_s[k]) / self._durations_s[k], 1.0)
        left_s = (total - done) / _speed(done, now_s - self._began_s)
        name = self._names[k]
        self._job.publish(MoveProgress(k, name, fraction, done, left_s, self._pivot_off(name)))

    def warn(self, sentence: str) -> None:
        """Forward it."""
        if self._job is not None:
            self._job.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` if somebody asked the job to stop."""
        if self._job is not None:
            self._job.raise_if_cancelled()


def _speed(done_s: float, spent_s: float) -> float:
    """Planned seconds per second: above 1 in a sped-up simulation, below with the speed slider down."""
    return max(done_s / spent_s, 1e-3) if spent_s > _MEASURED_SPEED_AFTER_S and done_s > 0 else 1.0


@dataclass(frozen=True)
class Offer:
    """What was planned and shown, and waits to be confirmed; it is executed once at most.

    Attributes:
        number: names it in the confirmation.
        task: the session it belongs to.
        pouring: that executes it.
        fresh: the plan of a pour; none if the arm backs off.
        back: the moves of backing off.
        T_flange_cup: (4, 4) the cup in the hand.
    """

    number: int
    task: SessionTask
    pouring: Pouring
    fresh: FreshPlan | None
    back: tuple[PlannedMove, ...]
    T_flange_cup: FloatArray


def shown_pour(
    offer: Offer, fresh: FreshPlan, prepared: PreparedPour, connected: ConnectedArm
) -> PlannedPour:
    """Return a planned pour as the page shows it."""
    return PlannedPour(
        offer.number,
        fresh.plan,
        fresh.target.note or prepared.sentence,
        prepared.advice,
        fresh.made_s + connected.arm.settings.motion.expires_s,
        fresh.target.pivot_m,
        offer.T_flange_cup,
        _mouth_path_m(fresh.plan.moves, offer.T_flange_cup, fresh.target.pouring.cup.length_m, connected),
    )


def shown_back_off(offer: Offer, connected: ConnectedArm) -> PlannedBackOff:
    """Return a planned path back as the page shows it."""
    length_m = offer.task.parameters.pouring.cup.length_m
    path_m = _mouth_path_m(offer.back, offer.T_flange_cup, length_m, connected)
    return PlannedBackOff(offer.number, offer.back, offer.T_flange_cup, path_m)


def pivot_off(connected: ConnectedArm, fresh: FreshPlan, T_flange_cup: FloatArray) -> PivotOff:
    """Return what measures how far the pivot is from its place, by the joint angles."""
    T_flange_pivot = T_flange_cup @ make_pose(np.eye(3), pivot_in_cup_m(fresh.target.pouring.cup))

    def measure(move: str) -> float | None:
        if move != Segment.POUR:
            return None
        T_base_pivot = connected.arm.robot.state().T_base_flange @ T_flange_pivot
        return float(np.linalg.norm(T_base_pivot[:3, 3] - fresh.target.pivot_m))

    return measure


def refuse_late(confirmed_s: float) -> None:
    """Refuse a confirmation that is not from just now.

    Raises:
        MotionError: it is older than `CONFIRMED_FOR_S`.
    """
    if not 0 <= time.monotonic() - confirmed_s <= CONFIRMED_FOR_S:
        raise MotionError("The confirmation came too late, so nothing moved. Confirm again.")


def refuse_stale(pipeline: Pipeline) -> None:
    """Refuse a session whose pours are not those that its parameters would give.

    Raises:
        StageError: it has to be imagined (again).
    """
    stages = freshness(pipeline.session, pipeline.parameters)
    if any(stages[name] is not Freshness.FRESH for name in IMAGINED):
        raise StageError("The imagination is not up to date; imagine again, then plan the pour.")


def refuse_other_target(pipeline: Pipeline, target: PourTarget) -> None:
    """Refuse a plan whose pour is not the chosen one any more.

    Raises:
        MotionError: the object was imagined again, or another pour was chosen.
    """
    view = SessionView(pipeline.session)
    if view.pours is None or view.pours.digest != target.digest:
        raise MotionError("The object was imagined again since this plan was made; plan again.")
    if view.place != (target.i, target.j):
        raise MotionError("Another pour was chosen since this plan was made; plan again.")


def refuse_closed_gripper(connected: ConnectedArm) -> None:
    """Refuse to begin with a closed gripper: it would push the cup over.

    Raises:
        MotionError: it is closed.
        RobotError: the arm does not answer.
    """
    if connected.arm.gripper.is_closed:
        raise MotionError("The gripper was closed since this plan was made; open it, then plan again.")


def _mouth_path_m(
    moves: Sequence[PlannedMove], T_flange_cup: FloatArray, length_m: float, connected: ConnectedArm
) -> FloatArray:
    """The path (N, 3) of the middle of the cup's mouth while the cup is in the hand."""
    joints = [move.trajectory.joints_rad[::_SHOWN_SAMPLES] for move in moves if move.holds_cup]
    if not joints:
        return np.zeros((0, 3))
    flanges = flange_pose(connected.arm.robot.kinematics.model, np.concatenate(joints))
    return np.asarray((flanges @ T_flange_cup @ np.array([0.0, 0.0, length_m, 1.0]))[:, :3])
