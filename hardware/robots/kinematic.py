"""The arm's kinematic twin: it is where its motion says, in this process, without forces."""

from __future__ import annotations

import time
from threading import RLock

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.motion.kinematics import flange_pose
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused, RobotError, RobotStopped
from hardware.interfaces import Kinematics, ReadyStep, RobotState
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.joint_motion import JointMotion, TrajectoryMotion, checked_path

_POLL_S = 0.004
_Motion = JointMotion | TrajectoryMotion


class KinematicRobot:
    """Moves as the real controller's joint moves do, by the clock; or, if `is_instant`, by jumping.

    Attributes:
        name: the model, marked as simulated.
        kinematics: by which its flange is where it says.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        joints_rad: npt.ArrayLike,
        is_instant: bool,
        T_flange_tool: FloatArray | None = None,
    ) -> None:
        """Begin at rest at `joints_rad` (6,), with a tool frame (4, 4), by default the flange's."""
        self.kinematics = kinematics
        self._arm = kinematics.model
        self.name = f"simulated {self._arm.name}"
        self._is_instant = is_instant
        self._T_flange_tool = np.eye(4) if T_flange_tool is None else T_flange_tool
        self._is_stopped = False
        self._lock = RLock()
        self._begin(JointMotion(np.array([joints_rad], dtype=float), 1.0, 1.0))

    def __enter__(self) -> KinematicRobot:
        self._is_stopped = False
        return self

    def __exit__(self, *exception: object) -> None:
        self._brake()

    def state(self) -> RobotState:
        """Return where the joints are now."""
        with self._lock:
            now_s = time.monotonic()
            joints, speeds, _ = self._motion.at(self._elapsed(now_s))
            flange = flange_pose(self._arm, joints)
            return RobotState(
                joints, joints, speeds, flange, flange @ self._T_flange_tool, RobotMode.RUNNING,
                SafetyMode.NORMAL, True, (False, False), 1.0, now_s, now_s,
            )  # fmt: skip

    def move_joints(
        self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float
    ) -> KinematicMove:
        """Start to move through configurations (N, 6), the first being where the arm is.

        Raises:
            RobotError: a configuration lies outside the joint limits, or the arm is elsewhere or moving.
        """
        path = checked_path(self._arm, self.name, path_rad)
        return self._start(JointMotion(path, speed_rad_s, acceleration_rad_s2), path[0])

    def follow(self, trajectory: JointTrajectory, margin: PathMargin | None = None) -> KinematicMove:  # noqa: ARG002
        """Start to follow a timed motion of the joints, by the clock; it never leaves its path.

        Raises:
            RobotError: as with `move_joints`.
        """
        checked_path(self._arm, self.name, trajectory.joints_rad)
        return self._start(TrajectoryMotion(trajectory), trajectory.start_rad)

    def stop(self) -> None:
        """Slow down to rest, and refuse further moves until `recover`."""
        with self._lock:
            self._is_stopped = True
            self._brake()

    def refuse_unsafe(self, trajectory: JointTrajectory, label: str) -> None:
        """It has no safety system."""

    def stopped_by(self) -> RobotError | None:
        """Whether it was stopped and not recovered."""
        return self._refusal() if self._is_stopped else None

    def pending_step(self) -> None:
        """Nothing: it is always ready."""

    def take_step(self, step: ReadyStep) -> None:
        """Nothing to do."""

    def recover(self) -> None:
        """Take moves again; what was stopped does not go on."""
        with self._lock:
            self._is_stopped = False

    def progress_of(self, motion: _Motion) -> float | None:
        """Return the share of a motion that is done, 0 to 1; none when another one took its place."""
        with self._lock:
            if motion is not self._motion:
                return None
            done_rad = motion.at(self._elapsed(time.monotonic()))[2]
            return done_rad / motion.length_rad if motion.length_rad else 1.0

    def _start(self, motion: _Motion, start_rad: FloatArray) -> KinematicMove:
        with self._lock:
            state = self.state()
            if self._is_stopped:
                raise self._refusal()
            if np.abs(state.joint_speeds_rad_s).max() > 0:
                raise RobotError(f"The {self.name} is still moving; stop it or wait until it stops.")
            if np.abs(start_rad - state.joints_rad).max() > 1e-3:
                raise RobotError(f"The {self.name} is not where the motion begins; plan it anew.")
            self._begin(motion)
            return KinematicMove(self, motion)

    def _refusal(self) -> MoveRefused:
        return MoveRefused(f"The {self.name} was stopped; see that all is well, then recover the robot.")

    def _brake(self) -> None:
        with self._lock:
            elapsed_s = self._elapsed(time.monotonic())
            if elapsed_s < self._motion.duration_s:
                self._begin(*self._motion.stopping(elapsed_s))

    def _begin(self, motion: _Motion, elapsed_s: float = 0.0) -> None:
        self._motion = motion
        self._start_s = time.monotonic() - elapsed_s

    def _elapsed(self, now_s: float) -> float:
        return float("inf") if self._is_instant else now_s - self._start_s


class KinematicMove:
    """A motion of the kinematic twin."""

    def __init__(self, robot: KinematicRobot, motion: _Motion) -> None:
        """Follow `motion`, which the robot has begun."""
        self._robot = robot
        self._motion = motion
        self._last = 0.0

    @property
    def progress(self) -> float:
        """Share of the path that is done, 0 to 1."""
        self._last = self._robot.progress_of(self._motion) or self._last
        return self._last

    @property
    def is_done(self) -> bool:
        """Whether it has ended, at its target or not."""
        progress = self._robot.progress_of(self._motion)
        return progress is None or progress >= 1

    def wait(self, timeout_s: float) -> None:
        """Wait until the target is reached.

        Raises:
            RobotStopped: the motion ended elsewhere.
            RobotError: it did not end in time.
        """
        deadline_s = time.monotonic() + timeout_s
        while (progress := self._robot.progress_of(self._motion)) is not None and progress < 1:
            if time.monotonic() > deadline_s:
                raise RobotError(f"The {self._robot.name} did not arrive within {timeout_s:g} s; stop it.")
            time.sleep(_POLL_S)
        if progress is None:
            raise RobotStopped(f"The {self._robot.name} was stopped before it arrived; plan its motion anew.")

    def stop(self) -> None:
        """Stop where the arm is now."""
        self._robot.stop()
