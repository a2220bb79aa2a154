"""How the worker moves the arm: joint moves one after the other, or a timed motion as a stream of targets.

Both are driven by the controller's states, one step for each, and never block.
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from typing import Protocol

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused, TrackingLost
from hardware.robots.ur.checks import beside_path, deviation, raise_if, tracking_lost

ARRIVED_RAD = 1e-3
RESTING_RAD_S = 1e-3
_STUCK_S = 1.0
"""An arm at rest for this long without having arrived was lost before its target."""
_LOOKAHEAD_S = 0.03
"""Least that servoj takes: its smoothing cuts corners by the square of this time."""
_GAIN = 300.0
_MOST_CYCLES = 2
"""The trajectory's clock never advances more at a time: after a hiccup the arm goes on and does not hurry."""
_LAG_S = 0.5
"""How far behind its targets the arm may be during a motion: servoj's smoothing and the link's latency."""
_LAG_SAMPLES = 101
_PATH_RAD = 0.02
"""A lagging arm is late on its path, not beside it; so little is 17 mm at full reach."""
_JUST_NOW_S, _LEARNED_S = 0.3, 1.5
"""A lag is compared with older ones: one that grows because of a fault is noticed before it counts."""
_LATER, _LATE_S = 1.3, 0.06
_TELLING_RAD_S = 0.1
_STANDS_S, _MOST_OF_IT_S = 0.1, 0.03
"""So long an arm must be seen to stand; of a pause between two states no more counts: nobody looked then."""
_STANDING_RAD_S, _MOVING_RAD_S = 0.01, 0.05
_SLOWED = 0.3
"""With the speed slider lower than this a standing arm says nothing."""
_SETTLE_S = 1.0
_SETTLED_RAD_S2 = 2.0
_LAST_BIT_RAD = 0.02
_LAST_BIT_SPEED_RAD_S, _LAST_BIT_ACCELERATION_RAD_S2 = 0.05, 0.5


class Control(Protocol):
    """What is used of ur_rtde's control interface."""

    def moveJ(self, q: list[float], speed: float, acceleration: float, asynchronous: bool) -> bool: ...  # noqa: D102

    def servoJ(  # noqa: D102
        self, q: list[float], speed: float, acceleration: float, time: float, lookahead: float, gain: float
    ) -> bool: ...

    def servoStop(self, a: float) -> bool: ...  # noqa: D102

    def stopJ(self, a: float, asynchronous: bool) -> None: ...  # noqa: D102


def joints_at_rest(raw: AnyArray) -> FloatArray | None:
    """Return the joints (6,), rad, of a state of `FIELDS` in which the arm rests; none if it moves."""
    is_at_rest = np.abs(raw["joint_speeds_rad_s"]).max() < RESTING_RAD_S
    return raw["joints_rad"] if is_at_rest else None


class Motion(Protocol):
    """A motion under way.

    Attributes:
        progress: share that is done, 0 to 1.
        is_streaming: whether every step sends a target, which the controller's watchdog hears, too.
    """

    progress: float
    is_streaming: bool

    def step(self, raw: AnyArray) -> bool:
        """Go on, at a new state of `FIELDS`; returns whether the target is reached.

        Raises:
            RobotError: the arm does not do what it should and has to be stopped.
        """
        ...

    def stop(self, deceleration_rad_s2: float) -> None:
        """Brake."""
        ...


class JointMoves:
    """Straight joint moves from corner to corner; the arm stops at each."""

    is_streaming = False

    def __init__(
        self, control: Control, path_rad: FloatArray, speed_rad_s: float, acceleration_rad_s2: float
    ) -> None:
        """Begin nothing yet: the first state does."""
        self.progress = 0.0
        self._control = control
        self._speed, self._acceleration = speed_rad_s, acceleration_rad_s2
        lengths = [float(np.abs(end - start).max()) for start, end in pairwise(path_rad)]
        self._total_rad = sum(lengths)
        # A move to where the arm is would never show that it was begun.
        self._left = [
            (end, length) for end, length in zip(path_rad[1:], lengths, strict=True) if length > ARRIVED_RAD
        ]
        self._is_under_way = False
        self._from_rad = np.array(path_rad[0])
        self._resting_since_s: float | None = None

    def step(self, raw: AnyArray) -> bool:
        """Begin the next move when the arm is at a corner; see `Motion`."""
        raise_if(deviation(raw))
        if self._left and self._is_under_way:
            raise_if(tracking_lost(raw["joints_rad"], self._segment(raw), "its path"))
        if self._left and self._is_under_way and self._has_arrived(raw):
            self._left.pop(0)
            self._is_under_way = False
        if self._left and not self._is_under_way:
            self._begin(raw)
        ahead_rad = sum(length for _, length in self._left[1:])
        if self._left:
            ahead_rad += min(float(np.abs(self._left[0][0] - raw["joints_rad"]).max()), self._left[0][1])
        self.progress = 1 - ahead_rad / self._total_rad if self._total_rad else 1.0
        return not self._left

    def stop(self, deceleration_rad_s2: float) -> None:
        """Brake; returns before the arm is at rest."""
        self._left.clear()
        self._control.stopJ(deceleration_rad_s2, True)

    def _segment(self, raw: AnyArray) -> FloatArray:
        """The point (1, 6) of the present straight move that is nearest to where the joints are."""
        way_rad = self._left[0][0] - self._from_rad
        share = float(np.clip(way_rad @ (raw["joints_rad"] - self._from_rad) / (way_rad @ way_rad), 0, 1))
        return np.array([self._from_rad + share * way_rad])

    def _begin(self, raw: AnyArray) -> None:
        self._is_under_way = True
        self._from_rad = np.array(raw["joints_rad"])
        self._resting_since_s = float(raw["time_s"])
        if not self._control.moveJ(self._left[0][0].tolist(), self._speed, self._acceleration, True):
            raise MoveRefused("The controller did not take the move; recover the robot and plan anew.")

    def _has_arrived(self, raw: AnyArray) -> bool:
        if np.abs(raw["joint_speeds_rad_s"]).max() > RESTING_RAD_S:
            self._resting_since_s = None
            return False
        if np.abs(self._left[0][0] - raw["joints_rad"]).max() < ARRIVED_RAD:
            return True
        now_s = float(raw["time_s"])
        if self._resting_since_s is None or raw["speed_scaling"] < 0.01:
            self._resting_since_s = now_s
        if now_s - self._resting_since_s > _STUCK_S:
            raise TrackingLost(
                "The arm has stopped, but not where it was sent; see what holds it, then recover the robot "
                "and plan anew."
            )
        return False


class UsualLag:
    """How late the arm is on its paths, by the link and the servo, as seen since the driver connected."""

    def __init__(self) -> None:
        self._followed_s = 0.0
        self._usual_s = 0.0
        self._recent: deque[tuple[float, float]] = deque()

    @property
    def most_s(self) -> float:
        """More than this is unusual; as much as may ever be, as long as little was seen."""
        is_known = self._followed_s > _LEARNED_S
        return min(_LATER * self._usual_s + _LATE_S, _LAG_S) if is_known else _LAG_S

    def is_unusual(self, lag_s: float, passed_s: float) -> bool:
        """Note a lag, some time after the one before; whether it is more than it ever was until just now."""
        self._followed_s += passed_s
        self._recent.append((self._followed_s, lag_s))
        while self._recent[0][0] < self._followed_s - _JUST_NOW_S:
            self._usual_s = max(self._usual_s, self._recent.popleft()[1])
        return self._followed_s > _LEARNED_S and lag_s > _LATER * self._usual_s + _LATE_S


class Following:
    """A timed motion, streamed with servoj, paced by the controller's time stamps."""

    def __init__(
        self,
        control: Control,
        trajectory: JointTrajectory,
        cycle_s: float,
        margin: PathMargin | None = None,
        lag: UsualLag | None = None,
    ) -> None:
        """Begin nothing yet: the first state does.

        Args:
            control: takes the targets.
            trajectory: to follow.
            cycle_s: time between two states.
            margin: how far beside its path the arm may be; none: a usual distance of each joint.
            lag: what was learned from the motions before; none: nothing.
        """
        self.progress = 0.0
        self.is_streaming = True
        self._control = control
        self._trajectory = trajectory
        self._cycle_s = cycle_s
        self._margin = margin
        self._lag = lag or UsualLag()
        self._clock_s = 0.0
        self._last_s: float | None = None
        self._settles_since_s: float | None = None
        self._seen_lag_s: float | None = None
        self._seen_s, self._stood_s = 0.0, 0.0
        self._last_bit: JointMoves | None = None

    def step(self, raw: AnyArray) -> bool:
        """Send the next target; see `Motion`."""
        if self._last_bit is not None:
            return self._last_bit.step(raw)
        raise_if(deviation(raw))
        now_s = float(raw["controller_s"])
        passed_s = 0.0 if self._last_s is None else now_s - self._last_s
        self._last_s = now_s
        self._clock_s += min(max(passed_s, 0.0), _MOST_CYCLES * self._cycle_s) * float(raw["speed_scaling"])
        self.progress = min(self._clock_s / self._trajectory.duration_s, 1.0)
        expected_rad = self._expected()
        raise_if(self._beside_path(raw["joints_rad"], expected_rad))
        self._refuse_standing(raw, expected_rad)
        if self._clock_s >= self._trajectory.duration_s:
            if self._settles_since_s is None:
                # Ended one step later at the earliest: `progress` tells before that the end takes its time.
                self._settles_since_s = float(raw["time_s"])
            elif self._is_settled(raw) or raw["time_s"] - self._settles_since_s > _SETTLE_S:
                return self._finish(raw)
        target = self._trajectory.at(self._clock_s).tolist()
        if not self._control.servoJ(target, 0.0, 0.0, self._cycle_s, _LOOKAHEAD_S, _GAIN):
            raise MoveRefused("The controller takes no targets; recover the robot and plan anew.")
        return False

    def stop(self, deceleration_rad_s2: float) -> None:
        """Brake; returns when the arm is at rest."""
        if self._last_bit is not None:
            self._last_bit.stop(deceleration_rad_s2)
        else:
            self._control.servoStop(deceleration_rad_s2)

    def _expected(self) -> FloatArray:
        """Where (N, 6) the arm may be now: the last part of its commanded path."""
        times_s = self._clock_s - np.linspace(0.0, _LAG_S, _LAG_SAMPLES)
        return np.column_stack(
            [np.interp(times_s, self._trajectory.times_s, column) for column in self._trajectory.joints_rad.T]
        )

    def _beside_path(self, joints_rad: FloatArray, expected_rad: FloatArray) -> TrackingLost | None:
        if self._margin is None:
            return tracking_lost(joints_rad, expected_rad, "its path", _PATH_RAD)
        bound_m, nearest = self._margin.bound_m(joints_rad, expected_rad)
        step_s = _LAG_S / (_LAG_SAMPLES - 1)
        around_rad = expected_rad[max(nearest - 1, 0) : nearest + 2]
        path_rad_s = np.abs(np.diff(around_rad, axis=0)).min(axis=0).max() / step_s
        # where the path rests there is no telling how late the arm is on it
        is_late = path_rad_s > _TELLING_RAD_S and self._lag.is_unusual(nearest * step_s, self._cycle_s)
        if bound_m > self._margin.allowed_m and is_late:
            return TrackingLost(
                "The arm is late and leaves its path, as if another program had taken it over, and was "
                "stopped; see what runs on the controller and what holds the arm, then recover the robot and "
                "plan anew."
            )
        return beside_path(joints_rad, expected_rad, self._margin)

    def _refuse_standing(self, raw: AnyArray, expected_rad: FloatArray) -> None:
        """Refuse an arm at rest while all of the last part of its path moves: no lag explains that.

        How late the arm is when it begins to move tells how long that part is; before, it is as long as the
        lags on earlier paths make it.

        Raises:
            TrackingLost: it has been so for some time; perhaps another program has the arm.
        """
        steps_rad = np.abs(np.diff(expected_rad, axis=0)).max(axis=1)
        is_at_rest = np.abs(raw["joint_speeds_rad_s"]).max() < _STANDING_RAD_S
        if self._seen_lag_s is None and np.abs(raw["joint_speeds_rad_s"]).max() > _MOVING_RAD_S:
            self._seen_lag_s = max(self._clock_s - self._moves_from_s(), 0.0)
        lag_s = self._lag.most_s if self._seen_lag_s is None else _LATER * self._seen_lag_s + _LATE_S
        step_s = _LAG_S / (_LAG_SAMPLES - 1)
        slowest_rad_s = float(steps_rad[: max(round(lag_s / step_s), 1)].min()) / step_s
        seen_s, self._seen_s = self._seen_s, float(raw["time_s"])
        if not is_at_rest or slowest_rad_s < _MOVING_RAD_S or raw["speed_scaling"] < _SLOWED:
            self._stood_s = 0.0
            return
        self._stood_s += min(self._seen_s - seen_s, _MOST_OF_IT_S)
        if self._stood_s > _STANDS_S:
            raise TrackingLost(
                "The arm stands while its path goes on, as if another program had taken it over; see what "
                "runs on the controller and what holds the arm, then recover the robot and plan anew."
            )

    def _moves_from_s(self) -> float:
        """When the path is for the first time as fast as an arm that is said to move."""
        speeds_rad_s = np.abs(np.diff(self._trajectory.joints_rad, axis=0)).max(axis=1)
        speeds_rad_s /= np.diff(self._trajectory.times_s)
        return float(self._trajectory.times_s[(speeds_rad_s > _MOVING_RAD_S).argmax()])

    def _is_settled(self, raw: AnyArray) -> bool:
        is_still = np.abs(raw["joint_speeds_rad_s"]).max() < RESTING_RAD_S
        return bool(is_still and self._apart_rad(raw) < ARRIVED_RAD / 2)

    def _finish(self, raw: AnyArray) -> bool:
        """Leave servoing; a small remaining distance is covered as a slow joint move."""
        self.is_streaming = False
        self._control.servoStop(_SETTLED_RAD_S2)
        apart_rad = self._apart_rad(raw)
        if apart_rad < ARRIVED_RAD:
            return True
        if apart_rad > _LAST_BIT_RAD:
            raise TrackingLost(
                f"The arm ended {np.degrees(apart_rad):.1f} degrees from the end of its path; see what holds "
                "it, then recover the robot and plan anew."
            )
        path = np.array([raw["joints_rad"], self._trajectory.end_rad])
        self._last_bit = JointMoves(self._control, path, _LAST_BIT_SPEED_RAD_S, _LAST_BIT_ACCELERATION_RAD_S2)
        return False

    def _apart_rad(self, raw: AnyArray) -> float:
        return float(np.abs(raw["joints_rad"] - self._trajectory.end_rad).max())
