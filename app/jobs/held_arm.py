"""A connected arm in its host process, and the thread that tells how it is."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus
from core.errors import MotionError
from hardware.errors import RobotError, RobotLost, RobotNotReady
from hardware.readiness import unreadiness

if TYPE_CHECKING:
    from hardware.cell.arm import Arm
    from hardware.interfaces import RobotState
    from hardware.pouring.pouring import Pouring

_EVERY_S, _EVERY_S_MOVING = 0.1, 0.05
_STANDING_RAD_S = 2e-3


class HeldArm:
    """An arm that was entered; it is let go once.

    Attributes:
        arm: robot and gripper.
        pouring: what is done with it; none before the first plan.
        T_flange_cup: (4, 4) the cup in the hand, by the last plan.
        must_recover: whether it was stopped, and takes no moves until somebody has looked.
        is_at_work: whether a job moves it or makes it ready.
    """

    def __init__(self, arm: Arm, tell: Callable[[Any], None]) -> None:
        """Tell that it is connected, and from now on how it is."""
        self.arm = arm
        self.pouring: Pouring | None = None
        self.T_flange_cup = np.eye(4)
        self.must_recover = False
        self.is_at_work = False
        self._tell = tell
        self._is_over = Event()
        address = arm.controller.address if arm.controller is not None else arm.settings.robot.address
        tell(ArmConnected(arm.robot.name, address, arm.controller is not None))
        self._thread = Thread(target=self._watch, name="arm status", daemon=True)
        self._thread.start()

    @property
    def must_back_off(self) -> bool:
        """Whether a run was stopped on its way."""
        return self.pouring is not None and self.pouring.is_interrupted

    @property
    def is_lost(self) -> bool:
        """Whether it was told to be gone."""
        return self._is_over.is_set()

    def let_go(self) -> None:
        """Disconnect; what moves is stopped."""
        self._is_over.set()
        self._thread.join()
        self.arm.__exit__(None, None, None)

    def refuse_unready(self) -> None:
        """Refuse an arm that takes no moves, or that stands on the way of a stopped run.

        Raises:
            RobotError: what has to be done first.
            MotionError: it has to back off first.
        """
        problem = self._problem(self.arm.robot.state())
        if problem:
            raise RobotNotReady(problem)
        if self.must_back_off:
            raise MotionError("The arm was stopped on its way; let it back off first.")

    def refuse_moving(self) -> None:
        """Refuse an arm that does not stand still.

        Raises:
            RobotError: it moves.
        """
        if np.abs(self.arm.robot.state().joint_speeds_rad_s).max() > _STANDING_RAD_S:
            raise RobotNotReady("The arm moves; wait until it stands.")

    def _watch(self) -> None:
        while not self._is_over.wait(_EVERY_S_MOVING if self.is_at_work else _EVERY_S):
            try:
                self._tell(self._status())
            except RobotLost:
                self._is_over.set()
                self._tell(
                    ArmGone(
                        f"The link to the {self.arm.robot.name} was lost, so what it does is not known; look "
                        "at the arm and at the network cable, then connect again."
                    )
                )

    def _status(self) -> ArmStatus:
        """How it is now.

        Raises:
            RobotLost: it does not answer, and nobody is about to find out why.
        """
        try:
            state = self.arm.robot.state()
            is_closed = self.arm.gripper.is_closed
        except RobotError as error:
            if isinstance(error, RobotLost) and not self.is_at_work and not self.must_back_off:
                raise
            return ArmStatus(None, None, str(error), self.must_back_off)
        return ArmStatus(state, is_closed, self._problem(state), self.must_back_off)

    def _problem(self, state: RobotState) -> str:
        unready = unreadiness(state.safety_mode, state.robot_mode)
        if unready is not None:
            return str(unready)
        if self.must_recover:
            return "The arm was stopped; see that all is well, then make it ready again."
        if not state.is_program_running:
            return "The control program of the arm does not run any more; make the arm ready again."
        return ""
