"""One arm, one object, one pour: plan from where the arm stands, carry out, and back off after a stop.

Between the steps a person decides; nothing here asks, and nothing goes on by itself.
"""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.cell import PourCell
from core.motion.pour.checking import check_plan
from core.motion.pour.plan import PlannedMove, PourPlan
from core.motion.pour.planning import plan_pour
from core.motion.pour.recovery import plan_back_off
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.session import explained
from core.session.pour_runs import next_run_folder
from hardware.cell import Arm
from hardware.errors import RobotError
from hardware.pouring.measuring import driven_pivot_error_m
from hardware.pouring.procedure import PourProcedure
from hardware.pouring.run_log import RunLog

PLAN_FOLDER = "plan"
SENT_FILE = "controller.json"
"""What a simulated controller received, the newest of it."""
_NEWEST = 2000


@dataclass(frozen=True)
class PourTarget:
    """The pour to make: what was imagined and chosen.

    Attributes:
        object_aabb_m: (2, 3) the object's box in the base frame.
        i: index of the direction.
        j: index of the distance.
        theta_rad: direction of the ray from p_E to the pivot.
        pivot_m: (3,) r_pivot.
        pouring: what was imagined with: the cup and the turn.
        digest: of the imagination it belongs to.
        note: why it is this one, if a person chose it; goes into the run's log.
    """

    object_aabb_m: FloatArray
    i: int
    j: int
    theta_rad: float
    pivot_m: FloatArray
    pouring: PouringParameters
    digest: str
    note: str = ""

    def plan(self, cell: PourCell, start_rad: FloatArray) -> PourPlan:
        """Plan it from joints (6,).

        Raises:
            MotionError: why the arm cannot make it.
        """
        where = self.i, self.j, self.theta_rad, self.pivot_m
        return plan_pour(cell, self.object_aabb_m, *where, self.pouring, start_rad)


@dataclass(frozen=True)
class FreshPlan:
    """A plan and the moment it was made: it expires."""

    plan: PourPlan
    target: PourTarget
    made_s: float


class Pouring:
    """Plans and makes one pour with an arm that is connected.

    Attributes:
        last_run: folder of the newest run; none before the first.
    """

    def __init__(
        self, arm: Arm, cell: PourCell, target: PourTarget, session: Path, reporter: Reporter
    ) -> None:
        self.last_run: Path | None = None
        self._arm = arm
        self._cell = cell
        self._target = target
        self._session = session
        self._reporter = reporter
        self._interrupted: tuple[PourPlan, tuple[PlannedMove, ...], int] | None = None

    @property
    def is_interrupted(self) -> bool:
        """Whether a run was stopped with the arm on its way, so that it has to back off first."""
        return self._interrupted is not None

    def plan(self) -> FreshPlan:
        """Plan from where the arm stands now.

        Raises:
            MotionError: there is no way, a stopped run has to be backed off from first, or the gripper is
                closed, so that a cup may be in the hand that the plan knows nothing of.
            RobotError: the arm does not answer.
        """
        if self._interrupted is not None:
            raise MotionError("The arm was stopped on its way; let it back off before a new pour is planned.")
        if self._arm.gripper.is_closed:  # what an earlier program left: this one planned no way back for it
            raise MotionError(
                "The gripper is closed, so a cup may be in the hand; take it out, open the gripper and drive "
                "the arm home at its panel, then pour anew."
            )
        plan = self._target.plan(self._cell, self._arm.robot.state().joints_rad)
        return FreshPlan(plan, self._target, time.monotonic())

    def carry_out(self, fresh: FreshPlan) -> Path:
        """Check once more that all is as planned, then pour; return the run's folder.

        Raises:
            MotionError: the plan has expired or does not stand the check; nothing has moved.
            DeviceError: the arm was stopped; see `PourProcedure.run`.
            Cancelled: somebody asked to stop; the arm stands.
        """
        self._refuse_outdated(fresh)
        plan = fresh.plan
        folder = next_run_folder(self._session)
        with RunLog(folder) as log:
            with explained(folder):
                (folder / PLAN_FOLDER).mkdir()
                plan.save(folder / PLAN_FOLDER)
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
        """Make the arm take moves again; it does not move.

        Raises:
            RobotError: a person has to do something first; the sentence says what.
        """
        self._arm.robot.recover()

    def plan_back_off(self) -> tuple[PlannedMove, ...]:
        """Plan the way back from where the arm was stopped: along the checked way, the cup to its station.

        Raises:
            MotionError: the arm was moved away from its planned way meanwhile.
        """
        assert self._interrupted is not None, "asked only after a stop on the way"
        plan, moves, index = self._interrupted
        joints_rad = self._arm.robot.state().joints_rad
        return plan_back_off(plan, moves, index, joints_rad)

    def back_off(self, moves: tuple[PlannedMove, ...]) -> Path:
        """Make the way back; return the run's folder. Raises as `carry_out` does."""
        assert self._interrupted is not None, "planned before"
        plan = self._interrupted[0]
        folder = next_run_folder(self._session)
        with RunLog(folder) as log:
            log.event("confirmed", "Backing off was confirmed.", plan=plan.digest, is_back_off=True)
            self._make(plan, moves, log)
        return folder

    def _make(self, plan: PourPlan, moves: tuple[PlannedMove, ...], log: RunLog) -> None:
        procedure = PourProcedure(self._arm, moves, log, self._reporter)
        try:
            procedure.run()
        except BaseException:
            if procedure.current >= 0:
                self._interrupted = plan, moves, procedure.current
            raise
        finally:
            self._keep_what_was_sent(log.folder)
        self._interrupted = None

    def _measure(self, plan: PourPlan, log: RunLog) -> None:
        cup, cell = self._target.pouring.cup, self._cell
        error_m = driven_pivot_error_m(
            log.folder, cell.arm, cell.T_flange_grasp @ plan.T_grasp_cup, cup, self._target.pivot_m
        )
        log.event("measured", f"The pivot stayed within {error_m * 1000:.2f} mm.", pivot_error_m=error_m)

    def _keep_what_was_sent(self, folder: Path) -> None:
        """A simulated controller remembers what it received; a real one keeps its own log."""
        if self._arm.controller is not None:
            with suppress(RobotError), explained(folder):
                (folder / SENT_FILE).write_text(self._arm.controller.command(f"log {_NEWEST}") + "\n")

    def _refuse_outdated(self, fresh: FreshPlan) -> None:
        target, plan = self._target, fresh.plan
        if fresh.target.digest != target.digest:
            raise MotionError("The object was imagined anew since this plan was made; plan anew.")
        if time.monotonic() - fresh.made_s > self._cell.limits.expires_s:
            raise MotionError("The plan has expired; plan anew.")
        check_plan(self._cell, target.object_aabb_m, target.pouring, plan, target.pivot_m, target.theta_rad)
        apart_rad = np.abs(self._arm.robot.state().joints_rad - plan.start_rad).max()
        if apart_rad > 2e-3:
            raise MotionError("The arm was moved since this plan was made; plan anew.")
