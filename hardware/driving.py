"""Following planned motions with an arm that is watched meanwhile; whoever pours and scans shares it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Protocol

import numpy as np

from core.geometry import FloatArray
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from core.progress import Reporter
from hardware.errors import (
    DeviceError,
    ProgramStopped,
    RobotError,
    RobotLost,
    RobotNotReady,
    TrackingLost,
)
from hardware.interfaces import Move, Robot, RobotState
from hardware.modes import SafetyMode, unreadiness

SAME_PLACE_RAD = 2e-3
AT_REST_RAD_S = 2e-3
MOST_TIMES_PLANNED = 10.0
"""With the speed slider at 10 % a move takes ten times as long; beyond that something holds the arm."""
PATIENCE_S = 10.0
REST_WITHIN_S = 1.0
MAX_AGE_S = 0.5
MAX_DEVIATION_RAD = 0.06
"""A servoed arm lags on its path, which is not a deviation from it."""
_POLL_S = 0.005
_CAUSE_WITHIN_S = 0.3
"""So long a controller may take, when the arm is at rest, to say that its power has gone."""


class StateLog(Protocol):
    """Keeps states of the arm."""

    def state(self, move: str, state: RobotState) -> None:
        """Log a state during a move of this name."""
        ...


class SlownessTold:
    """Says what makes an arm slow, each thing once until it is over."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self._slowed_by = ""

    def tell(self, state: RobotState) -> None:
        """Say it if it is new."""
        slow = slowness(state)
        kind = slow.partition(" at ")[0]
        if slow and kind != self._slowed_by:
            self._reporter.warn(slow)
        self._slowed_by = kind


class WatchedArm:
    """Follows one motion after the other; any fault raises, and `stop` brings the arm to rest then.

    Attributes:
        slowness: what was said of what makes it slow.
    """

    def __init__(
        self, robot: Robot, log: StateLog, reporter: Reporter, slowness: SlownessTold | None = None
    ) -> None:
        """Drive a connected arm.

        Args:
            robot: the arm.
            log: keeps its states.
            reporter: knows whether somebody cancels.
            slowness: see above; none: nothing was said yet.
        """
        self.slowness = slowness or SlownessTold(reporter)
        self._robot = robot
        self._log = log
        self._reporter = reporter

    def ready_state(self) -> RobotState:
        """Return the newest state of an arm that may be commanded.

        Raises:
            RobotError: it may not; its kind and sentence say why.
        """
        state = self._robot.state()
        if state.age_s > MAX_AGE_S:
            # this computer was suspended since then, and the arm may have reported more
            state = self._robot.state()
        refuse_unready(state)
        return state

    def refuse_stopped(self) -> RobotState:
        """Return the newest state of an arm that was not stopped while it was at rest.

        Raises:
            RobotError: it was, for example because another program moved it.
        """
        error = self._robot.stopped_by()
        if error is not None:
            raise error
        return self.ready_state()

    def refuse_elsewhere(self, start_rad: FloatArray) -> None:
        """Refuse an arm that is not at rest at (6,): plans are made from there.

        Raises:
            TrackingLost: it is elsewhere, or moves.
        """
        state = self.refuse_stopped()
        apart_rad = np.abs(state.joints_rad - start_rad).max()
        if apart_rad > SAME_PLACE_RAD or np.abs(state.joint_speeds_rad_s).max() > AT_REST_RAD_S:
            raise TrackingLost(
                "The arm is not at rest where the plan starts (a joint is "
                f"{np.degrees(apart_rad):.1f} degrees off); plan again."
            )
        self.slowness.tell(state)

    def follow(
        self,
        trajectory: JointTrajectory,
        name: str,
        label: str,
        margin: PathMargin | None = None,
        watch: Callable[[RobotState, float], None] = lambda *_: None,
    ) -> None:
        """Follow a motion to its end.

        Args:
            trajectory: of the joints.
            name: of the motion, for the log.
            label: as shown to the user.
            margin: how far beside its path the arm may be; none: as far as usual.
            watch: called with every state and the share that is done; what it raises ends the motion.

        Raises:
            Cancelled: a stop was requested. The arm may still move: call `stop`.
            DeviceError: the sentence says what happened. The same.
        """
        self.ready_state()
        handle = self._robot.follow(trajectory, margin)

        def look(state: RobotState) -> None:
            refuse_deviation(state, trajectory, margin)
            watch(state, handle.progress)

        try:
            self._watch(handle, trajectory.duration_s, name, label, look)
        except TrackingLost as lost:
            raise self._cause(lost, handle) from None
        handle.wait(REST_WITHIN_S)
        self._log.state(name, self.ready_state())

    def stop(self) -> FloatArray | None:
        """Stop the arm and wait for its rest; return its joints (6,), or none if it does not answer."""
        with suppress(DeviceError):
            self._robot.stop()
        with suppress(DeviceError):
            return self._wait_for_rest().joints_rad
        return None

    def _watch(
        self,
        handle: Move,
        planned_s: float,
        name: str,
        label: str,
        look: Callable[[RobotState], None],
    ) -> None:
        deadline_s = time.monotonic() + MOST_TIMES_PLANNED * planned_s + PATIENCE_S
        while not handle.is_done:
            self._reporter.raise_if_cancelled()
            state = self.ready_state()
            self._log.state(name, state)
            self.slowness.tell(state)
            look(state)
            if time.monotonic() > deadline_s:
                raise RobotError(
                    f"The arm did not finish '{label}' in time and was stopped; find out what holds it."
                )
            time.sleep(_POLL_S)

    def _cause(self, lost: TrackingLost, handle: Move) -> RobotError:
        """Stop an arm that has left its path, and return the gravest thing to be seen then.

        An arm whose power or program ends brakes beside its path, and its controller says so only afterwards.
        """
        self.stop()
        deadline_s = time.monotonic() + _CAUSE_WITHIN_S
        while time.monotonic() < deadline_s:
            try:
                self.ready_state()
            except RobotError as graver:
                return graver
            time.sleep(_POLL_S)
        try:
            handle.wait(0.0)
        except ProgramStopped as ended:
            return ended
        except RobotError:  # by our own stop, or what the driver says of the same deviation
            return lost
        return lost

    def _wait_for_rest(self) -> RobotState:
        deadline_s = time.monotonic() + REST_WITHIN_S
        while True:
            state = self._robot.state()
            is_at_rest = np.abs(state.joint_speeds_rad_s).max() < AT_REST_RAD_S
            if is_at_rest or time.monotonic() > deadline_s:
                return state
            time.sleep(_POLL_S)


def refuse_restricted(
    robot: Robot, motions: Iterable[tuple[JointTrajectory, str]], slowness: SlownessTold
) -> None:
    """Refuse motions, each with its label, that what is set on the arm's controller does not allow.

    To be called before somebody confirms them; what only makes the arm slow is said.

    Raises:
        RobotError: the sentence says what does not allow which of them.
    """
    state = robot.state()
    if state.speed_scaling < _STILL:
        raise RobotNotReady(
            "The speed slider is at 0, so nothing would move; raise it at the panel, then plan again."
        )
    for trajectory, label in motions:
        robot.refuse_unsafe(trajectory, label)
    slowness.tell(state)


_FULL_SPEED, _STILL = 0.99, 0.005


def slowness(state: RobotState) -> str:
    """Say why the arm will be slower than planned; empty if it will not."""
    if state.safety_mode is SafetyMode.REDUCED:
        return "The safety system is in reduced mode, so the arm is slower than planned, or is stopped by it."
    if state.speed_scaling < _STILL:
        return "The speed slider is at 0: nothing moves until somebody raises it at the panel."
    if state.speed_scaling < _FULL_SPEED:
        return f"The speed slider is at {state.speed_scaling:.0%}: everything takes longer than planned."
    return ""


def refuse_unready(state: RobotState) -> None:
    """Refuse a state in which the arm must not be commanded.

    Raises:
        RobotError: its kind and sentence say why.
    """
    if state.age_s > MAX_AGE_S:
        raise RobotLost(
            f"The arm has not reported for {state.age_s:.1f} s; look at it, and check its network cable."
        )
    unready = unreadiness(state.safety_mode, state.robot_mode)
    if unready is not None:
        raise unready


def refuse_deviation(
    state: RobotState, trajectory: JointTrajectory, margin: PathMargin | None = None
) -> None:
    """Refuse a state that is off the path.

    Raises:
        TrackingLost: a joint, or by the margin a point of the arm, is too far from every sample of the path.
    """
    path_rad = trajectory.joints_rad
    if margin is not None and (off_m := margin.beside_m(state.joints_rad, path_rad)) > margin.allowed_m:
        raise TrackingLost(
            f"The arm is up to {off_m * 1000:.1f} mm off its planned path, where its clearance leaves "
            f"{margin.allowed_m * 1000:.1f} mm, and was stopped; find out what holds or pushes it."
        )
    deviation_rad = float(np.abs(path_rad - state.joints_rad).max(axis=1).min())
    if deviation_rad > MAX_DEVIATION_RAD:
        raise TrackingLost(
            f"The arm is {np.degrees(deviation_rad):.1f} degrees off its planned path and was stopped; "
            "find out what holds or pushes it."
        )
