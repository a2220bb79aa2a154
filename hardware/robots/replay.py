"""The arm of a recorded scan: it is always where the next view was taken from."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import ArmModel
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.cameras.replay import ReplayCamera
from hardware.interfaces import Kinematics, ReadyStep, RobotState
from hardware.modes import RobotMode, SafetyMode


class ReplayRobot:
    """Follows a replay camera; its joints are not known and stay zero.

    Attributes:
        name: says that nothing moves.
        kinematics: of the cell's model.
    """

    def __init__(self, camera: ReplayCamera, T_flange_camera: FloatArray, arm: ArmModel) -> None:
        """Be where the camera is where the recorded one was."""
        self.name = "arm of a recorded scan"
        self.kinematics = Kinematics(arm)
        self._camera = camera
        self._T_camera_flange = invert_pose(T_flange_camera)

    def __enter__(self) -> ReplayRobot:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def state(self) -> RobotState:
        """Return where the last given view was taken from."""
        T_base_camera = self._camera.T_base_camera
        pose = np.eye(4) if T_base_camera is None else T_base_camera @ self._T_camera_flange
        now_s = time.monotonic()
        zeros = np.zeros(6)
        return RobotState(
            zeros, zeros, zeros, pose, pose, RobotMode.RUNNING, SafetyMode.NORMAL, True, (False, False),
            1.0, now_s, now_s,
        )  # fmt: skip

    def move_joints(self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float) -> _NoMove:
        """Nothing moves."""
        del path_rad, speed_rad_s, acceleration_rad_s2
        return _NoMove()

    def follow(self, trajectory: JointTrajectory, margin: PathMargin | None = None) -> _NoMove:
        """Nothing moves."""
        del trajectory, margin
        return _NoMove()

    def stop(self) -> None:
        """Nothing moves."""

    def refuse_unsafe(self, trajectory: JointTrajectory, label: str) -> None:
        """Nothing moves."""

    def stopped_by(self) -> None:
        """Nothing moves."""

    def pending_step(self) -> None:
        """Nothing: there is no arm."""

    def take_step(self, step: ReadyStep) -> None:
        """Nothing to do."""

    def recover(self) -> None:
        """Nothing was stopped."""


class _NoMove:
    is_done = True
    progress = 1.0

    def wait(self, timeout_s: float) -> None:
        del timeout_s

    def stop(self) -> None:
        pass
