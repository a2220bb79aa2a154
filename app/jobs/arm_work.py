"""Pouring with the arm, for a host process."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event as Flag
from typing import TYPE_CHECKING

from app.jobs.arm_events import ArmDisconnected, PlannedBackOff, PlannedPour, StepPending, StopDone
from app.jobs.messages import Event
from app.jobs.service import JobReporter, Service
from app.operations.session import SessionTask, working_on
from core.errors import Cancelled, InputError, MotionError, PoursightError
from core.workers import WorkerPool
from hardware.errors import RobotError, RobotNotReady

if TYPE_CHECKING:
    from app.jobs.connected_arm import ConnectedArm, Offer
    from hardware.cell.settings import CellSettings
    from hardware.interfaces import ReadyStep

_STOP_ORDER_S = 0.2
"""The window also stops the controller directly, so its order to stop may come later than the stop."""


class ArmWork(Service):
    """Holds a connected arm: plans pours for it, makes them, and lets it back off after a stop.

    A job that moves names what was shown by its number, and the moment of its confirmation, so that neither a
    repeated nor a late call moves anything.
    """

    GIVES_WAY = False

    def __init__(self, send: Callable[[Event], None]) -> None:
        super().__init__(send)
        self._connected: ConnectedArm | None = None
        self._offer: Offer | None = None
        self._count = 0
        self._reporter: JobReporter | None = None
        self._was_stopped = Flag()

    def prepare(self) -> None:
        """Import what the first job would wait for."""
        from app.operations import pouring  # noqa: F401 - takes a second

    def close(self) -> None:
        """Stop what moves and disconnect."""
        self._disconnect()

    def connect(self, reporter: JobReporter, cell: CellSettings, step: ReadyStep | None = None) -> None:
        """Connect a cell's arm and gripper, instead of those that are connected; nothing moves.

        A step that somebody confirmed is taken first; one that is in the way is published.

        Raises:
            DeviceError: one of them is not there or not ready.
            InputError: the cell has no arm.
        """
        from app.jobs.connected_arm import ConnectedArm
        from app.operations.arm import warn_of_kinematics
        from hardware.cell import open_arm

        with self._job(reporter):
            self._disconnect()
            arm = open_arm(cell)
            if step is not None:
                arm.robot.take_step(step)
            try:
                arm.__enter__()
            except RobotError:
                pending = arm.robot.pending_step()
                if pending is not None:
                    reporter.publish(StepPending(*pending))
                raise
            try:
                reporter.raise_if_cancelled()
            except Cancelled:
                arm.__exit__(None, None, None)
                raise
            warn_of_kinematics(arm, reporter)
            self._connected = ConnectedArm(arm, lambda payload: self._send(Event(payload)))

    def disconnect(self, reporter: JobReporter) -> None:
        """Disconnect the arm."""
        with self._job(reporter):
            self._disconnect()

    def plan(self, reporter: JobReporter, task: SessionTask, cell: CellSettings) -> PlannedPour:
        """Plan the session's chosen pour from where the arm is.

        Raises:
            StageError: there is no pour to make, or what was imagined is stale.
            MotionError: the arm cannot make it, has to back off first, or may hold a cup.
            RobotError: the arm is not connected or not ready.
        """
        from app.jobs.connected_arm import Offer, refuse_stale, shown_pour
        from app.operations.pouring import cell_to_pour_in, prepare
        from hardware.pouring.pouring import Pouring

        with self._job(reporter):
            connected = self._arm()
            connected.refuse_unready()
            if connected.arm.settings != cell:
                raise InputError("The connected arm belongs to another cell; connect this cell's arm.")
            with WorkerPool() as pool, working_on(task, pool, reporter) as pipeline:
                refuse_stale(pipeline)
                prepared = prepare(pipeline, cell)
            target = prepared.chosen()
            pour_cell = cell_to_pour_in(prepared, task.folder, reporter)
            pouring = Pouring(connected.arm, pour_cell, target, task.folder, connected.moves)
            if connected.arm.gripper.is_closed and (known := pouring.take_up()):
                raise connected.left_by_earlier_program(pouring, prepared.cell, known)
            fresh = pouring.plan()
            connected.pouring = pouring
            connected.T_flange_cup = prepared.cell.T_flange_grasp @ fresh.plan.T_grasp_cup
            self._offer = Offer(self._next(), task, pouring, fresh, (), connected.T_flange_cup)
            return shown_pour(self._offer, fresh, prepared, connected)

    def pour(self, reporter: JobReporter, number: int, confirmed_s: float) -> Path:
        """Make the pour that was planned last, and return the run's folder; the session is locked meanwhile.

        Args:
            reporter: of the job.
            number: of the plan that was shown.
            confirmed_s: `time.monotonic` of its confirmation.

        Raises:
            MotionError: it is not the plan that was shown last, has expired, or was confirmed too long ago;
                nothing has moved.
            DeviceError: the arm was stopped; it has to be made ready and to back off.
            Cancelled: somebody asked to stop; the same.
        """
        from app.jobs.connected_arm import pivot_off, refuse_closed_gripper, refuse_other_target

        with self._job(reporter):
            connected = self._arm()
            offer = self._confirmed(number, confirmed_s)
            assert offer.fresh is not None, "the page pours only what it shows as a pour"
            connected.refuse_unready()
            refuse_closed_gripper(connected)
            with WorkerPool() as pool, working_on(offer.task, pool, reporter) as pipeline:
                refuse_other_target(pipeline, offer.fresh.target)
                off = pivot_off(connected, offer.fresh, offer.T_flange_cup)
                connected.moves.begin(reporter, offer.fresh.plan.moves, off)
                with self._moving(connected):
                    return offer.pouring.carry_out(offer.fresh)

    def recover(self, reporter: JobReporter, step: ReadyStep | None = None) -> None:
        """After a stop, make the arm ready to move again; it does not move.

        A step that somebody confirmed is taken first; one that is in the way is published.

        Raises:
            RobotError: a person has to do something first.
        """
        with self._job(reporter):
            connected = self._arm()
            self._offer = None
            connected.must_recover = False  # now, so that a stop that comes meanwhile is not forgotten
            connected.is_at_work = True
            robot = connected.arm.robot
            try:
                stopped = connected.pouring or robot  # a pour writes down what is done
                if step is not None:
                    stopped.take_step(step)
                stopped.recover()
            except RobotError:
                connected.must_recover = True
                pending = robot.pending_step()
                if pending is not None:
                    reporter.publish(StepPending(*pending))
                raise
            finally:
                connected.is_at_work = False

    def plan_back_off(self, reporter: JobReporter, task: SessionTask) -> PlannedBackOff:
        """Plan backing off from where the arm was stopped.

        Raises:
            MotionError: no run was stopped midway, or the arm is off its path.
            RobotError: the arm is not connected.
        """
        from app.jobs.connected_arm import Offer, shown_back_off

        with self._job(reporter):
            connected = self._arm()
            pouring = connected.pouring
            if pouring is None or not pouring.is_interrupted:
                raise MotionError("No run was stopped midway, so there is nothing to back off from.")
            moves = pouring.plan_back_off()
            self._offer = Offer(self._next(), task, pouring, None, moves, connected.T_flange_cup)
            return shown_back_off(self._offer, connected)

    def back_off(self, reporter: JobReporter, number: int, confirmed_s: float) -> Path:
        """Back off as planned last, and return the run's folder; raises as `pour` does."""
        with self._job(reporter):
            connected = self._arm()
            offer = self._confirmed(number, confirmed_s)
            with WorkerPool() as pool, working_on(offer.task, pool, reporter):
                connected.moves.begin(reporter, offer.back, lambda _: None)
                with self._moving(connected):
                    return offer.pouring.back_off(offer.back)

    def move_gripper(self, reporter: JobReporter, is_closing: bool, confirmed_s: float) -> None:
        """Close or open the gripper of an arm at rest.

        Raises:
            MotionError: a run was stopped midway, or the confirmation came late.
            DeviceError: the arm is not ready, or the gripper does not answer.
        """
        from app.jobs.connected_arm import refuse_late

        with self._job(reporter):
            connected = self._arm()
            refuse_late(confirmed_s)
            self._offer = None  # it was planned for the gripper as it was
            connected.refuse_unready()
            connected.refuse_moving()
            if is_closing:
                connected.arm.gripper.close()
            else:
                connected.arm.gripper.open()

    def stop(self) -> None:
        """Stop the arm, at once, and whatever job there is; the arm does not move again until `recover`."""
        began_s, problem = time.monotonic(), ""
        self._was_stopped.set()
        connected, reporter = self._connected, self._reporter
        try:
            if connected is not None:
                connected.must_recover = True
                connected.arm.robot.stop()
        except PoursightError as error:
            problem = str(error)
        finally:
            if reporter is not None:
                reporter.cancel()
        if connected is not None:
            self._send(Event(StopDone(time.monotonic() - began_s, problem)))

    @contextmanager
    def _job(self, reporter: JobReporter) -> Iterator[None]:
        """Let a stop find the job that is under way."""
        self._reporter = reporter
        try:
            yield
        finally:
            self._reporter = None

    def _arm(self) -> ConnectedArm:
        """Return the connected arm.

        Raises:
            RobotError: none is.
        """
        connected = self._connected
        if connected is None or connected.is_lost:
            raise RobotNotReady("No arm is connected; connect it first.")
        return connected

    @contextmanager
    def _moving(self, connected: ConnectedArm) -> Iterator[None]:
        """The arm moves; after anything unexpected a person has to check it before it moves again."""
        connected.is_at_work = True
        self._was_stopped.clear()
        try:
            yield
        except MotionError:
            raise  # nothing has moved
        except BaseException as error:
            connected.must_recover = True
            if isinstance(error, Cancelled) or self._was_stopped.wait(_STOP_ORDER_S):
                raise Cancelled("Stopped on request: the arm is at rest where it was stopped.") from error
            raise
        finally:
            connected.is_at_work = False

    def _confirmed(self, number: int, confirmed_s: float) -> Offer:
        """Take the offer of a number; it is not offered any more.

        Raises:
            MotionError: it is not what was shown last, or its confirmation came late.
        """
        from app.jobs.connected_arm import refuse_late

        offer, self._offer = self._offer, None
        if offer is None or offer.number != number:
            raise MotionError("This is not the plan that was made last; nothing moved. Plan again.")
        refuse_late(confirmed_s)
        return offer

    def _next(self) -> int:
        self._count += 1
        return self._count

    def _disconnect(self) -> None:
        connected, self._connected, self._offer = self._connected, None, None
        if connected is not None:
            connected.disconnect()
            self._send(Event(ArmDisconnected()))
