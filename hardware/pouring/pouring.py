"""One arm, one object, one pour: plan from the present configuration, execute, and back off after a stop.

Between the steps a person decides; nothing here asks, and nothing continues by itself.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.errors import MotionError, SessionError
from core.motion.pour.cell import PourCell
from core.motion.pour.checking import check_plan
from core.motion.pour.margins import plan_margins, refuse_misplaced
from core.motion.pour.plan import PlannedMove, PourPlan, PourTarget, is_reversed
from core.motion.pour.planning import plan_pour
from core.motion.pour.recovery import check_rejoining, on_the_way_back, plan_back_off
from core.motion.trajectory import JointTrajectory
from core.progress import Reporter
from core.session import explained
from core.session.pour_runs import next_run_folder, pour_runs, unfinished_run
from core.session.swapping import flush
from hardware.cell import Arm
from hardware.driving import SAME_PLACE_RAD, SlownessTold, WatchedArm, refuse_restricted
from hardware.errors import RobotError
from hardware.interfaces import ReadyStep, Robot
from hardware.pouring.procedure import ConfirmMove, PourProcedure, no_question
from hardware.pouring.recovering import LoggedRecovery
from hardware.pouring.run_log import RunLog, driven_pivot_error_m

PLAN_FOLDER = "plan"
SENT_FILE = "controller.json"
"""The newest of what a simulated controller received."""
_NEWEST = 2000


@dataclass(frozen=True)
class FreshPlan:
    """A plan, the pour it was made for, and `time.monotonic` of when: it expires."""

    plan: PourPlan
    target: PourTarget
    made_s: float


class Pouring:
    """Plans and executes one pour with a connected arm.

    Attributes:
        last_run: folder of the newest run; none before the first.
    """

    def __init__(
        self,
        arm: Arm,
        cell: PourCell,
        target: PourTarget,
        session: Path,
        reporter: Reporter,
        confirm_move: ConfirmMove = no_question,
    ) -> None:
        """`confirm_move` is asked before each move but the first, which is confirmed with the plan."""
        self.last_run: Path | None = None
        self._arm = arm
        self._published_cell = cell
        self._target = target
        self._session = session
        self._reporter = reporter
        self._confirm_move = confirm_move
        self._slowness = SlownessTold(reporter)
        self._interrupted: tuple[PourPlan, tuple[PlannedMove, ...], int] | None = None

    @property
    def _cell(self) -> PourCell:
        """With the kinematics of the arm that is connected, which is known only when it is."""
        return replace(self._published_cell, arm=self._arm.robot.kinematics.model)

    @property
    def robot(self) -> Robot:
        """That pours."""
        return self._arm.robot

    @property
    def gripper(self) -> str:
        """Name of what holds the cup."""
        return self._arm.gripper.name

    @property
    def interrupted_plan(self) -> PourPlan | None:
        """Whose path the arm was stopped on; none if it was not."""
        return None if self._interrupted is None else self._interrupted[0]

    @property
    def is_interrupted(self) -> bool:
        """Whether a run was stopped on its path, so that the arm has to back off first."""
        return self._interrupted is not None

    @property
    def interrupted_move(self) -> PlannedMove | None:
        """In which the arm was stopped on its path; none if it was not."""
        if self._interrupted is None:
            return None
        _, moves, index = self._interrupted
        return moves[index]

    def plan(self) -> FreshPlan:
        """Plan from the present configuration.

        Raises:
            MotionError: there is no plan, a stopped run has to be backed off from first, or the gripper is
                closed, so that it may hold a cup the plan knows nothing of.
            RobotError: the arm does not respond, or its controller does not allow the plan.
        """
        if self._interrupted is not None:
            raise MotionError(
                "The arm was stopped on its path; let it back off before a new pour is planned."
            )
        if self._arm.gripper.is_closed:
            # left by an earlier program
            raise MotionError(
                "The gripper is closed, so it may hold a cup; hold it, take it out and open the gripper, "
                "then plan again."
            )
        plan = plan_pour(self._cell, self._target, self._arm.robot.state().joints_rad)
        refuse_restricted(self._arm.robot, _forwards(plan), self._slowness)
        return FreshPlan(plan, self._target, time.monotonic())

    def carry_out(self, fresh: FreshPlan) -> Path:
        """Check once more that everything is as planned, then pour; return the run's folder.

        Raises:
            MotionError: the plan has expired or fails the check; nothing has moved.
            DeviceError: the arm was stopped; see `PourProcedure.run`.
            Cancelled: a stop was requested; the arm is at rest.
        """
        self._refuse_outdated(fresh)
        plan = fresh.plan
        folder = next_run_folder(self._session)
        with RunLog(folder) as log:
            with explained(folder):
                (folder / PLAN_FOLDER).mkdir()
                plan.save(folder / PLAN_FOLDER)
                flush(folder / PLAN_FOLDER)  # the way back is planned along it
            log.event(
                "confirmed",
                f"Pour {plan.i}, {plan.j} was confirmed: {plan.duration_s:.0f} s.",
                plan=plan.digest,
                imagination=fresh.target.digest,
                note=fresh.target.note,
            )
            self.last_run = folder
            self._make(plan, plan.moves, log)
            self._measure(plan, log)
        return folder

    def recover(self) -> None:
        """Make the arm accept moves again; it does not move.

        Raises:
            RobotError: a person has to do something first; the sentence says what.
        """
        with self._recovering() as arm:
            arm.recover()

    def take_step(self, step: ReadyStep) -> None:
        """Do what has to be done first, which somebody confirmed; the arm follows no path.

        Raises:
            RobotError: it could not be done.
        """
        with self._recovering() as arm:
            arm.take_step(step)

    def plan_back_off(self) -> tuple[PlannedMove, ...]:
        """Plan backing off from where the arm was stopped: along the checked path, the cup to its station.

        Raises:
            MotionError: the arm was moved away from its planned path meanwhile.
            MoveRefused: the controller does not allow that way.
            RobotError: the arm does not respond, or could not move.
        """
        assert self._interrupted is not None, "requested only after a stop on the path"
        plan, moves, index = self._interrupted
        joints_rad = self._arm.robot.state().joints_rad
        back = plan_back_off(plan, moves, index, joints_rad)
        gripper = self._arm.gripper
        if not gripper.is_closed or gripper.is_holding is False:
            back = tuple(replace(move, holds_cup=False) for move in back)  # it let go
        check_rejoining(self._cell, self._target, back)
        motions = [(move.trajectory, move.label) for move in back]
        refuse_restricted(self._arm.robot, motions, self._slowness)
        return back

    def take_up(self) -> str:
        """Find the run that left the arm where it is, with the gripper closed: an earlier program's.

        Returns what is known of it, in a sentence, and is interrupted then as if it had been this program's;
        empty if there is no such run.
        """
        run = unfinished_run(pour_runs(self._session))
        if run is None:
            return ""
        try:
            plan = PourPlan.load(run.folder / PLAN_FOLDER)
            check_plan(self._cell, self._target, plan)
        except (SessionError, MotionError):
            return ""
        index = on_the_way_back(plan, self._arm.robot.state().joints_rad)
        if index is None:
            return ""
        self._interrupted, self.last_run = (plan, plan.moves, index), run.folder
        return f"The arm is on the path of run {run.folder.name}. {run.sentence}"

    def give_up_way_back(self) -> None:
        """Let go of what is in the hand, where it is, and forget the path: the next plan begins here.

        Raises:
            DeviceError: the gripper does not open.
        """
        if self._arm.gripper.is_closed:
            self._arm.gripper.open()
        if self.last_run is not None:
            with RunLog(self.last_run) as log:
                log.event("gripper", "The gripper was opened where the arm stood.", is_closed=False)
        self._interrupted = None

    def back_off(self, moves: tuple[PlannedMove, ...]) -> Path:
        """Back off; return the run's folder. Raises as `carry_out` does."""
        assert self._interrupted is not None, "planned before"
        plan = self._interrupted[0]
        folder = self.last_run = next_run_folder(self._session)
        with RunLog(folder) as log:
            log.event("confirmed", "Backing off was confirmed.", plan=plan.digest, is_back_off=True)
            self._make(plan, moves, log)
        return folder

    @contextmanager
    def _recovering(self) -> Iterator[Robot | LoggedRecovery]:
        """The arm; what is done to it is written down once there is a run."""
        if self.last_run is None:
            yield self._arm.robot
            return
        with RunLog(self.last_run) as log:
            yield LoggedRecovery(self._arm.robot, log)

    def _make(self, plan: PourPlan, moves: tuple[PlannedMove, ...], log: RunLog) -> None:
        margins = plan_margins(self._cell, self._target, plan)
        watched = WatchedArm(self._arm.robot, log, self._reporter, self._slowness)
        procedure = PourProcedure(
            self._arm, moves, log, self._reporter, margins, self._cell, watched, self._confirm_move
        )
        try:
            procedure.run()
        except BaseException:
            if procedure.current >= 0:
                self._interrupted = plan, moves, procedure.current
            raise
        finally:
            self._save_what_was_sent(log.folder)
        self._interrupted = None

    def _measure(self, plan: PourPlan, log: RunLog) -> None:
        cup, cell = self._target.pouring.cup, self._cell
        error_m = driven_pivot_error_m(
            log.folder, cell.arm, cell.T_flange_grasp @ plan.T_grasp_cup, cup, self._target.pivot_m
        )
        log.event("measured", f"The pivot stayed within {error_m * 1000:.2f} mm.", pivot_error_m=error_m)

    def _save_what_was_sent(self, folder: Path) -> None:
        """A simulated controller records what it received; a real one keeps its own log."""
        if self._arm.controller is not None:
            with suppress(RobotError), explained(folder):
                (folder / SENT_FILE).write_text(self._arm.controller.command(f"log {_NEWEST}") + "\n")

    def _refuse_outdated(self, fresh: FreshPlan) -> None:
        target, plan = self._target, fresh.plan
        if fresh.target.digest != target.digest:
            raise MotionError("The object was imagined again since this plan was made; plan again.")
        if time.monotonic() - fresh.made_s > self._cell.limits.expires_s:
            raise MotionError("The plan has expired; plan again.")
        check_plan(self._cell, target, plan)
        state = self._arm.robot.state()
        if np.abs(state.joints_rad - plan.start_rad).max() > SAME_PLACE_RAD:
            raise MotionError("The arm was moved since this plan was made; plan again.")
        for margin in plan_margins(self._cell, target, plan).values():
            refuse_misplaced(margin, state.T_base_flange @ self._cell.T_flange_grasp, state.T_base_tool)
        for trajectory, label in _forwards(plan):
            self._arm.robot.refuse_unsafe(trajectory, label)


def _forwards(plan: PourPlan) -> list[tuple[JointTrajectory, str]]:
    """The motions of a plan, each with its label; those that are driven both ways once."""
    return [(move.trajectory, move.label) for move in plan.moves if not is_reversed(move)]
