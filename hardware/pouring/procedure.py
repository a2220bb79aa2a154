"""Carrying out planned moves one after the other; anything unexpected stops the arm and ends the run."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from core.motion.pour.plan import PlannedMove
from core.progress import Reporter
from hardware.cell import Arm
from hardware.errors import DeviceError, RobotError, TrackingLost
from hardware.interfaces import Move, RobotState
from hardware.pouring.run_log import RunLog
from hardware.pouring.watching import MAX_AGE_S, refuse_deviation, refuse_unready

STAGE = "pour"
SAME_PLACE_RAD = 2e-3
STANDING_RAD_S = 2e-3
MOST_TIMES_PLANNED = 10.0
"""A slider at 10 % makes a move ten times longer; beyond that something holds the arm."""
PATIENCE_S = 10.0
REST_WITHIN_S = 1.0
_POLL_S = 0.005


class PourProcedure:
    """Makes moves that were planned and checked, with an arm that is connected.

    Attributes:
        current: index of the move that is, or was last, under way; -1 before the first.
    """

    def __init__(self, arm: Arm, moves: Sequence[PlannedMove], log: RunLog, reporter: Reporter) -> None:
        self.current = -1
        self._arm = arm
        self._moves = tuple(moves)
        self._log = log
        self._reporter = reporter
        self._total_s = sum(move.trajectory.duration_s for move in self._moves)
        self._done_s = 0.0

    def run(self) -> None:
        """Make all moves. Whatever goes wrong: the arm is told to stop, and nothing goes on by itself.

        Raises:
            Cancelled: somebody asked to stop; the arm stands.
            DeviceError: the robot or the gripper; the sentence says what happened and what to do.
        """
        try:
            self._refuse_elsewhere()
            for index, move in enumerate(self._moves):
                self.current = index
                self._make(move)
        except BaseException as error:
            self._stop(error)
            raise
        self._log.event("done", "All moves were made.")

    def _refuse_elsewhere(self) -> None:
        """The arm must stand where the first move begins: plans are made from where it stands."""
        state = self._ready_state()
        apart_rad = np.abs(state.joints_rad - self._moves[0].trajectory.start_rad).max()
        if apart_rad > SAME_PLACE_RAD or np.abs(state.joint_speeds_rad_s).max() > STANDING_RAD_S:
            raise TrackingLost(
                "The arm does not stand where the plan begins (a joint is "
                f"{np.degrees(apart_rad):.1f} degrees away); plan anew."
            )

    def _make(self, move: PlannedMove) -> None:
        self._ready_state()
        self._log.event(
            "move",
            f"{move.name}: {move.trajectory.duration_s:.1f} s.",
            index=self.current,
            name=move.name,
            phase=move.phase.value,
        )
        handle = self._arm.robot.follow(move.trajectory)
        self._watch(handle, move)
        handle.wait(REST_WITHIN_S)
        self._log.state(move.name, self._ready_state())
        self._done_s += move.trajectory.duration_s
        if move.gripper_after is not None:
            self._grip(move.gripper_after == "close")

    def _watch(self, handle: Move, move: PlannedMove) -> None:
        duration_s = move.trajectory.duration_s
        deadline_s = time.monotonic() + MOST_TIMES_PLANNED * duration_s + PATIENCE_S
        while not handle.is_done:
            self._reporter.raise_if_cancelled()
            state = self._ready_state()
            self._log.state(move.name, state)
            refuse_deviation(state, move.trajectory)
            self._reporter.progress(STAGE, self._done_s + handle.progress * duration_s, self._total_s)
            if time.monotonic() > deadline_s:
                raise RobotError(
                    f"The arm did not finish '{move.name}' in time and was stopped; see what holds it."
                )
            time.sleep(_POLL_S)

    def _ready_state(self) -> RobotState:
        state = self._arm.robot.state()
        if (
            state.age_s > MAX_AGE_S
        ):  # the machine stood still since it was taken, and the arm may have told more
            state = self._arm.robot.state()
        refuse_unready(state)
        return state

    def _grip(self, is_closing: bool) -> None:
        gripper = self._arm.gripper
        if is_closing:
            gripper.close()
        else:
            gripper.open()
        done = "closed" if is_closing else "opened"
        if gripper.is_closed != is_closing:
            raise DeviceError(
                f"The {gripper.name} did not confirm that it {done}; check its cable and its supply of 24 V."
            )
        self._log.event("gripper", f"The gripper {done}.", is_closed=is_closing)

    def _stop(self, error: BaseException) -> None:
        with suppress(DeviceError):
            self._arm.robot.stop()
        joints_rad = None
        with suppress(DeviceError):
            joints_rad = self._wait_for_rest().joints_rad.tolist()
        self._log.event(
            "stopped",
            str(error) or type(error).__name__,
            error=type(error).__name__,
            index=self.current,
            joints_rad=joints_rad,
        )

    def _wait_for_rest(self) -> RobotState:
        deadline_s = time.monotonic() + REST_WITHIN_S
        while True:
            state = self._arm.robot.state()
            is_standing = np.abs(state.joint_speeds_rad_s).max() < STANDING_RAD_S
            if is_standing or time.monotonic() > deadline_s:
                return state
            time.sleep(_POLL_S)
