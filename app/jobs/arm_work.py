"""The arm that pours, for a host process."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

from app.jobs.arm_news import ArmGone, PlannedBackOff, PlannedPour, StopDone
from app.jobs.face import JobFace
from app.jobs.messages import News
from app.jobs.move_teller import MoveTeller
from app.jobs.service import Service
from app.jobs.session_work import SessionTask, working_on
from core.errors import Cancelled, InputError, MotionError, PoursightError
from core.workers import WorkerPool
from hardware.errors import RobotError, RobotNotReady

if TYPE_CHECKING:
    from app.jobs.arm_plans import Offer
    from app.jobs.held_arm import HeldArm
    from hardware.cell.settings import CellSettings

_STOP_COMES_S = 0.2


class ArmWork(Service):
    """Holds a connected arm: plans pours for it, makes them, and brings it back after a stop.

    What moves is named by the number of what was shown and by the moment of its confirmation, so that neither
    a repeated nor a late call moves anything.
    """

    GIVES_WAY = False

    def __init__(self, tell: Any) -> None:
        super().__init__(tell)
        self._held: HeldArm | None = None
        self._offer: Offer | None = None
        self._count = 0
        self._face: JobFace | None = None
        self._was_stopped = Event()
        self._teller = MoveTeller()
        self._pool = WorkerPool()

    def prepare(self) -> None:
        """Import what the first job would wait for."""
        from app import pouring  # noqa: F401 - takes a second, which the first job then has not to wait

    def close(self) -> None:
        """Stop what moves and disconnect."""
        self._let_go()
        self._pool.close()

    def connect(self, face: JobFace, cell: CellSettings) -> None:
        """Connect a cell's arm and gripper, instead of those that are connected; nothing moves.

        Raises:
            DeviceError: one of them is not there or not ready.
            InputError: the cell has no arm.
        """
        from app.jobs.held_arm import HeldArm
        from hardware.cell import open_arm

        with self._job(face):
            self._let_go()
            arm = open_arm(cell)
            arm.__enter__()
            try:
                face.raise_if_cancelled()
            except Cancelled:
                arm.__exit__(None, None, None)
                raise
            self._held = HeldArm(arm, lambda news: self._tell(News(news)))

    def disconnect(self, face: JobFace) -> None:
        """Let the arm go."""
        with self._job(face):
            self._let_go()

    def plan(self, face: JobFace, task: SessionTask, cell: CellSettings) -> PlannedPour:
        """Plan the session's chosen pour from where the arm stands.

        Raises:
            StageError: there is no pour to make, or what was imagined is stale.
            MotionError: the arm cannot make it, has to back off first, or may hold a cup.
            RobotError: the arm is not connected or not ready.
        """
        from app.jobs.arm_plans import Offer, refuse_stale, shown_pour
        from app.pouring import prepare
        from core.report import motion_sentence
        from hardware.pouring.pouring import Pouring

        with self._job(face), self._arm() as held:
            held.refuse_unready()
            if held.arm.settings != cell:
                raise InputError("The connected arm belongs to another cell; connect this cell's arm.")
            with self._pool_for_once(), working_on(task, self._pool, face) as pipeline:
                refuse_stale(pipeline)
                prepared = prepare(pipeline, cell)
            found = motion_sentence(prepared.motions, prepared.grid)
            target = prepared.target
            if target is None:
                raise MotionError(found)
            pouring = Pouring(held.arm, prepared.cell, target, task.folder, self._teller)
            fresh = pouring.plan()
            held.pouring = pouring
            held.T_flange_cup = prepared.cell.T_flange_grasp @ fresh.plan.T_grasp_cup
            self._offer = Offer(self._next(), task, pouring, fresh, (), held.T_flange_cup)
            return shown_pour(self._offer, fresh, target.note or found, held)

    def pour(self, face: JobFace, number: int, confirmed_s: float) -> Path:
        """Make the pour that was planned last, and return the run's folder; the session is held meanwhile.

        Args:
            face: of the job.
            number: of the plan that was shown.
            confirmed_s: `time.monotonic` of its confirmation.

        Raises:
            MotionError: it is not the plan that was shown last, has expired, or was confirmed too long ago;
                nothing has moved.
            DeviceError: the arm was stopped; it has to be made ready and to back off.
            Cancelled: somebody asked to stop; the same.
        """
        from app.jobs.arm_plans import pivot_off, refuse_closed_gripper, refuse_other_target

        with self._job(face), self._arm() as held:
            offer = self._taken(number, confirmed_s)
            assert offer.fresh is not None, "the page pours only what it shows as a pour"
            held.refuse_unready()
            refuse_closed_gripper(held)
            with working_on(offer.task, self._pool, face) as pipeline:
                refuse_other_target(pipeline, offer.fresh.target)
                off = pivot_off(held, offer.fresh, offer.T_flange_cup)
                self._teller.begin(face, offer.fresh.plan.moves, off)
                with self._moving(held):
                    return offer.pouring.carry_out(offer.fresh)

    def recover(self, face: JobFace) -> None:
        """After a stop, make the arm take moves again; it does not move.

        Raises:
            RobotError: a person has to do something first.
        """
        with self._job(face), self._arm() as held:
            self._offer = None
            held.must_recover = False  # now, so that a stop that comes meanwhile is not forgotten
            held.is_at_work = True
            try:
                held.arm.robot.recover()
            except RobotError:
                held.must_recover = True
                raise
            finally:
                held.is_at_work = False

    def plan_back_off(self, face: JobFace, task: SessionTask) -> PlannedBackOff:
        """Plan the way back from where the arm was stopped.

        Raises:
            MotionError: nothing was stopped on its way, or the arm stands beside its way.
            RobotError: the arm is not connected.
        """
        from app.jobs.arm_plans import Offer, shown_back_off

        with self._job(face), self._arm() as held:
            pouring = held.pouring
            if pouring is None or not pouring.is_interrupted:
                raise MotionError("The arm was not stopped on its way; there is no way back to be made.")
            moves = pouring.plan_back_off()
            self._offer = Offer(self._next(), task, pouring, None, moves, held.T_flange_cup)
            return shown_back_off(self._offer, held)

    def back_off(self, face: JobFace, number: int, confirmed_s: float) -> Path:
        """Make the way back that was planned last, and return the run's folder; raises as `pour` does."""
        with self._job(face), self._arm() as held:
            offer = self._taken(number, confirmed_s)
            with working_on(offer.task, self._pool, face):
                self._teller.begin(face, offer.back, lambda _: None)
                with self._moving(held):
                    return offer.pouring.back_off(offer.back)

    def move_gripper(self, face: JobFace, is_closing: bool, confirmed_s: float) -> None:
        """Close or open the gripper of an arm that stands.

        Raises:
            MotionError: the arm stands on the way of a stopped run, or the confirmation came late.
            DeviceError: the arm is not ready, or the gripper does not answer.
        """
        from app.jobs.arm_plans import refuse_late

        with self._job(face), self._arm() as held:
            refuse_late(confirmed_s)
            self._offer = None  # it was planned for the gripper as it was
            held.refuse_unready()
            held.refuse_moving()
            if is_closing:
                held.arm.gripper.close()
            else:
                held.arm.gripper.open()

    def stop(self) -> None:
        """Stop the arm, at once, and whatever job there is; the arm takes no moves until `recover`."""
        began_s, said = time.monotonic(), ""
        self._was_stopped.set()
        held, face = self._held, self._face
        try:
            if held is not None:
                held.must_recover = True
                held.arm.robot.stop()
        except PoursightError as error:
            said = str(error)
        finally:
            if face is not None:
                face.cancel()
        if held is not None:
            self._tell(News(StopDone(time.monotonic() - began_s, said)))

    @contextmanager
    def _job(self, face: JobFace) -> Iterator[None]:
        """Let a stop find the job that is under way."""
        self._face = face
        try:
            yield
        finally:
            self._face = None

    @contextmanager
    def _arm(self) -> Iterator[HeldArm]:
        """Give the connected arm.

        Raises:
            RobotError: none is.
        """
        held = self._held
        if held is None or held.is_lost:
            raise RobotNotReady("No arm is connected; connect it first.")
        yield held

    @contextmanager
    def _moving(self, held: HeldArm) -> Iterator[None]:
        """The arm moves; after anything unexpected somebody has to look before it moves again."""
        held.is_at_work = True
        self._was_stopped.clear()
        try:
            yield
        except MotionError:
            raise  # nothing has moved
        except BaseException as error:
            held.must_recover = True
            # The window's own way to the controller is the fastest: the order to stop may still be coming.
            if isinstance(error, Cancelled) or self._was_stopped.wait(_STOP_COMES_S):
                said = "Stopped on request: the arm stands where it was stopped."
                raise Cancelled(said) from error
            raise
        finally:
            held.is_at_work = False

    @contextmanager
    def _pool_for_once(self) -> Iterator[None]:
        """Workers are needed at most once a session, where nobody has judged its motions yet."""
        try:
            yield
        finally:
            self._pool.close()

    def _taken(self, number: int, confirmed_s: float) -> Offer:
        """What was offered under a number; it is not offered any more.

        Raises:
            MotionError: it is not what was shown last, or its confirmation came late.
        """
        from app.jobs.arm_plans import refuse_late

        offer, self._offer = self._offer, None
        if offer is None or offer.number != number:
            raise MotionError("This is not the plan that was made last; nothing moved. Plan anew.")
        refuse_late(confirmed_s)
        return offer

    def _next(self) -> int:
        self._count += 1
        return self._count

    def _let_go(self) -> None:
        held, self._held, self._offer = self._held, None, None
        if held is not None:
            held.let_go()
            self._tell(News(ArmGone()))
