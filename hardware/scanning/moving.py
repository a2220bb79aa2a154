"""How the arm gets to a view: a real one along a confirmed route and watched, a simulated one at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol

import numpy as np

from core.errors import MotionError, Remedy
from core.motion.joint_path import find_route
from core.motion.margin import PathMargin, path_margin
from core.motion.trajectory import JointTrajectory
from core.progress import Reporter
from hardware.cell import Cell
from hardware.driving import WatchedArm, refuse_restricted
from hardware.errors import RobotError
from hardware.interfaces import Move
from hardware.pouring.run_log import RunLog
from hardware.scanning.route import Leg, ScanRoute, plan_route, route_options
from hardware.scanning.views import PlannedView

RESTING_RAD_S = 1e-3
SAME_PLACE_RAD = 1e-3
MOVE_TIMEOUT_S = 60.0
STOP_TIMEOUT_S = 1.5
POLL_S = 0.02

RouteConfirmed = Callable[[ScanRoute], str]
"""Called with what the arm will do, before it does; says how that was confirmed, or raises `Cancelled`."""
CONFIRMED = "The route was confirmed."


class Moving(Protocol):
    """Brings the arm to views."""

    def prepare(self, views: Sequence[PlannedView]) -> None:
        """Get ready for these views, in their order.

        Raises:
            Cancelled: somebody does not want the arm to move.
            MotionError: the hand may hold a cup.
        """
        ...

    def go(self, view: PlannedView) -> None:
        """Go there; returns when the arm has arrived.

        Raises:
            MotionError: there is no clear way.
            RobotError: the arm was stopped; the sentence says why.
            Cancelled: a stop was requested; the arm is at rest.
        """
        ...

    def refuse_stopped(self) -> None:
        """Refuse an arm at a view that was stopped there, though nothing was asked of it.

        Raises:
            RobotError: it was; the sentence says why.
        """
        ...


class WatchedMoving:
    """A real arm: the whole route is planned and confirmed, then driven under watch, and logged.

    Attributes:
        was_stopped: whether it was stopped on its way, since the last route was confirmed.
    """

    def __init__(self, cell: Cell, log: RunLog, reporter: Reporter, confirm: RouteConfirmed) -> None:
        self.was_stopped = False
        self._cell = cell
        self._log = log
        self._confirm = confirm
        self._watched = WatchedArm(cell.robot, log, reporter)
        self._legs: dict[str, Leg] = {}

    def prepare(self, views: Sequence[PlannedView]) -> None:
        """Plan the route from where the arm is, and let somebody confirm it; see `Moving`."""
        if not views:
            return
        self._refuse_full_hand()
        route = plan_route(self._cell, self._watched.ready_state().joints_rad, views)
        legs = [(leg.trajectory, f"to {leg.view.name}") for leg in route.legs if leg.trajectory is not None]
        refuse_restricted(self._cell.robot, legs, self._watched.slowness)
        self._log.event("planned", route.sentence, views=[leg.view.name for leg in route.legs])
        self.was_stopped = False
        if route.n_views:
            self._log.event("confirmed", self._confirm(route))
        self._legs = {leg.view.name: leg for leg in route.legs}

    def go(self, view: PlannedView) -> None:
        """Follow the confirmed way; see `Moving`."""
        leg = self._legs[view.name]
        if leg.trajectory is None:
            raise MotionError(leg.problem)
        self._log.event("move", f"to {view.name}: {leg.trajectory.duration_s:.1f} s.", name=view.name)
        try:
            self._watched.refuse_elsewhere(leg.trajectory.start_rad)
            self._watched.follow(leg.trajectory, view.name, f"to {view.name}", self._margin(leg.trajectory))
        except BaseException as error:
            self._note_stop(error)
            raise

    def refuse_stopped(self) -> None:
        """The driver watches an arm at rest, too; see `Moving`."""
        try:
            self._watched.refuse_stopped()
        except RobotError as error:
            self._note_stop(error)
            raise

    def _refuse_full_hand(self) -> None:
        """Routes are checked without a cup, and would spill what is in it."""
        if self._cell.gripper.is_closed:
            raise MotionError("The gripper is closed and may hold a cup; nothing moved.", Remedy.EMPTY_HAND)

    def _note_stop(self, error: BaseException) -> None:
        self.was_stopped = True
        self._log.stopped(error, self._watched.stop())

    def _margin(self, trajectory: JointTrajectory) -> PathMargin:
        return path_margin(self._cell.scene, trajectory.joints_rad, self._cell.settings.scan.min_clearance_m)


class PlainMoving:
    """An arm near which nobody can be: each way is planned when its turn comes."""

    def __init__(self, cell: Cell, reporter: Reporter) -> None:
        self._cell = cell
        self._reporter = reporter

    def prepare(self, views: Sequence[PlannedView]) -> None:
        """Nothing to do; see `Moving`."""

    def go(self, view: PlannedView) -> None:
        """Go there, straight in joint space from corner to corner; see `Moving`."""
        robot, settings = self._cell.robot, self._cell.settings
        here_rad = robot.state().joints_rad
        if np.abs(here_rad - view.joints_rad).max() < SAME_PLACE_RAD:
            return
        path = find_route(self._cell.scene, here_rad, view.joints_rad, route_options(settings))
        self._follow(
            robot.move_joints(
                path, settings.robot.joint_speed_rad_s, settings.robot.joint_acceleration_rad_s2
            )
        )

    def refuse_stopped(self) -> None:
        """Whoever stops it ends the scan; see `Moving`."""

    def _follow(self, move: Move) -> None:
        """Wait until the move is over; stop the arm when somebody wants the scan to end."""
        deadline_s = time.monotonic() + MOVE_TIMEOUT_S
        try:
            while not move.is_done:
                self._reporter.raise_if_cancelled()
                if time.monotonic() > deadline_s:
                    raise RobotError(
                        f"The {self._cell.robot.name} did not arrive within {MOVE_TIMEOUT_S:.0f} s and was "
                        "stopped; find and remove what blocks it.",
                        Remedy.CONTINUE,
                    )
                time.sleep(POLL_S)
            move.wait(POLL_S)
        except BaseException:
            with suppress(RobotError):
                move.stop()
                self._wait_for_rest()
            raise

    def _wait_for_rest(self) -> None:
        """Wait until a stopped arm is at rest; a scan that goes on at once would find it moving.

        It is when two looks in succession say so: at the first one it may still come to rest.
        """
        deadline_s = time.monotonic() + STOP_TIMEOUT_S
        was_slow = False
        while time.monotonic() < deadline_s:
            is_slow = np.abs(self._cell.robot.state().joint_speeds_rad_s).max() <= RESTING_RAD_S
            if is_slow and was_slow:
                return
            was_slow = is_slow
            time.sleep(POLL_S)


class NoMoving:
    """A recorded scan: its arm is where the recorded view was taken."""

    def prepare(self, views: Sequence[PlannedView]) -> None:
        """Nothing to do; see `Moving`."""

    def go(self, view: PlannedView) -> None:
        """Nothing to do; see `Moving`."""

    def refuse_stopped(self) -> None:
        """Nothing can be stopped; see `Moving`."""
