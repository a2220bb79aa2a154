"""The moves of a pour, made one after the other by a connected arm that is watched meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from core.errors import Cancelled, MotionError
from core.motion.pour.cell import PourCell
from core.motion.pour.margins import MoveMargin, refuse_misplaced
from core.motion.pour.plan import PlannedMove, Segment
from core.progress import Reporter
from hardware.cell import Arm
from hardware.driving import WatchedArm
from hardware.errors import DeviceError, ObjectLost, OutputChanged, RobotStopped, TrackingLost
from hardware.interfaces import RobotState
from hardware.pouring.run_log import RunLog

STAGE = "pour"

ConfirmMove = Callable[[PlannedMove], None]
"""Asks whether a move shall begin; raises `Cancelled` if not. The arm is at rest meanwhile."""


def no_question(_: PlannedMove) -> None:
    """One confirmation is enough for all moves."""


class PourProcedure:
    """Executes moves that were planned and checked, with a connected arm.

    Attributes:
        current: index of the present or last move; -1 before the first.
    """

    def __init__(
        self,
        arm: Arm,
        moves: Sequence[PlannedMove],
        log: RunLog,
        reporter: Reporter,
        margins: Mapping[Segment, MoveMargin],
        cell: PourCell,
        watched: WatchedArm,
        confirm_move: ConfirmMove,
    ) -> None:
        """`margins` are those of the plan that the moves belong to, which was made for `cell`."""
        self.current = -1
        self._confirm_move = confirm_move
        self._margins = margins
        self._T_flange_tool = cell.T_flange_grasp
        self._max_force_n = cell.limits.max_force_n
        self._arm = arm
        self._watched = watched
        self._moves = tuple(moves)
        self._log = log
        self._reporter = reporter
        self._total_s = sum(move.trajectory.duration_s for move in self._moves)
        self._done_s = 0.0

    def run(self) -> None:
        """Execute all moves. Whatever goes wrong, the arm is stopped, and nothing continues by itself.

        Raises:
            Cancelled: a stop was requested; the arm is at rest.
            DeviceError: the robot or the gripper; the sentence says what happened and what to do.
        """
        try:
            self._watched.refuse_elsewhere(self._moves[0].trajectory.start_rad)
            for index, move in enumerate(self._moves):
                self.current = index
                if index:
                    self._confirm_move(move)
                self._make(move)
        except Cancelled as request:
            stopped = Cancelled("Stopped on request: the arm is at rest where it was stopped.")
            self._log.stopped(stopped, self._watched.stop(), index=self.current)
            raise stopped from request
        except BaseException as error:
            self._log.stopped(error, self._watched.stop(), index=self.current)
            raise
        self._log.event("done", "All moves were executed.")

    def _make(self, move: PlannedMove) -> None:
        self._log.event(
            "move",
            f"{move.label}: {move.trajectory.duration_s:.1f} s.",
            index=self.current,
            name=move.name,
            phase=move.phase.value,
        )
        duration_s = move.trajectory.duration_s

        margin = self._margin()
        resting_n = self._arm.robot.state().tool_force_n

        def watch(state: RobotState, progress: float) -> None:
            self._refuse_empty_hand(move)
            if move.holds_cup and state.tool_force_n - resting_n > self._max_force_n:
                raise RobotStopped(
                    f"Something pushes at the hand with the cup ({state.tool_force_n:.0f} N), so the arm was "
                    "stopped; see what it touches, and whether payload_kg is right."
                )
            try:
                refuse_misplaced(margin, state.T_base_flange @ self._T_flange_tool, state.T_base_tool)
            except MotionError as error:
                raise TrackingLost(str(error)) from error
            self._reporter.progress(STAGE, self._done_s + progress * duration_s, self._total_s)

        self._refuse_empty_hand(move)
        self._refuse_lost_cup(move)
        self._watched.follow(move.trajectory, move.name, move.label, margin.path, watch)
        self._done_s += duration_s
        if move.gripper_after is not None:
            self._grip(move.gripper_after == "close")

    def _margin(self) -> MoveMargin:
        """Of the present move; of the one that it leads to, where it is none of the plan's."""
        return next(
            self._margins[move.name] for move in self._moves[self.current :] if move.name in self._margins
        )

    def _refuse_empty_hand(self, move: PlannedMove) -> None:
        if move.holds_cup and not self._arm.gripper.is_closed:
            raise OutputChanged(
                f"The {self._arm.gripper.name} is open while it should hold the cup, so the arm was stopped; "
                "see to the cup, the cable and the 24 V supply."
            )

    def _refuse_lost_cup(self, move: PlannedMove) -> None:
        """While the arm moves, its driver watches a gripper that tells what it holds."""
        if move.holds_cup and self._arm.gripper.is_holding is False:
            raise ObjectLost(
                f"The {self._arm.gripper.name} holds nothing where it should hold the cup, so the arm stays "
                "where it is; see to the cup and what it lost."
            )

    def _grip(self, is_closing: bool) -> None:
        gripper = self._arm.gripper
        if is_closing:
            gripper.close()
        else:
            gripper.open()
        done = "closed" if is_closing else "opened"
        if gripper.is_closed != is_closing:
            raise DeviceError(
                f"The {gripper.name} did not confirm that it {done}; check its cable and its 24 V supply."
            )
        is_holding = gripper.is_holding
        if is_closing and is_holding is False:
            raise ObjectLost(
                f"The {gripper.name} closed and holds nothing, so the cup is not lifted; see whether it "
                "stands at its station."
            )
        held = " and holds the cup" if is_holding else ""
        self._log.event("gripper", f"The gripper {done}{held}.", is_closed=is_closing, is_holding=is_holding)
