"""Motions known from start to end: braking, straight lines in space, paths with blends.

Each tells where the joints are at a time after its start. Straight joint moves are
`hardware.robots.joint_motion.JointMotion`.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.inverse_kinematics import inverse_kinematics
from core.motion.kinematics import flange_pose, nearest_turn
from hardware.robots.trapezoid import Trapezoid
from hardware.simulation.ur_controller.poses import rotation_from_vector, vector_from_rotation

_SAMPLE_M = 0.002
_SAMPLE_RAD = 0.01
"""Between two samples of a straight line, the joints move evenly."""
_LARGEST_STEP_RAD = 0.3
"""A joint that would turn more between two samples passes a singularity or changes its branch."""


class NoSolution(Exception):
    """No configuration brings the tool there; the real controller ends the program with this."""


class Course(Protocol):
    """A motion as a function of time.

    Attributes:
        duration_s: from its start to rest.
    """

    duration_s: float

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints (6,), their speeds (6,) in rad/s, and a measure of how far it has come."""
        ...


class Braking:
    """All joints slow down evenly and come to rest together.

    Attributes:
        duration_s: until rest.
        end_rad: (6,) where they rest.
    """

    def __init__(self, joints_rad: FloatArray, speeds_rad_s: FloatArray, deceleration_rad_s2: float) -> None:
        """Brake the busiest joint with the given deceleration."""
        self._start, self._speeds = joints_rad, speeds_rad_s
        self.duration_s = float(np.abs(speeds_rad_s).max()) / deceleration_rad_s2
        self.end_rad: FloatArray = joints_rad + speeds_rad_s * (self.duration_s / 2)

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints, their speeds, and the share of the time."""
        if time_s >= self.duration_s:
            return self.end_rad, np.zeros(6), 1.0
        share = time_s / self.duration_s
        joints = self._start + self._speeds * (time_s * (1 - share / 2))
        return joints, self._speeds * (1 - share), share


class StraightLine:
    """The flange moves straight and turns evenly about one axis, from rest to rest.

    Attributes:
        duration_s: from rest to rest.
        end_rad: (6,) the joints at the end.
    """

    def __init__(
        self,
        arm: ArmModel,
        start_rad: FloatArray,
        T_base_flange: FloatArray,
        speed_m_s: float,
        acceleration_m_s2: float,
    ) -> None:
        """Plan the line from a configuration to a pose of the flange.

        Speed and acceleration are those of the flange's origin, or in rad/s and rad/s2 where it turns more
        than it travels.

        Raises:
            NoSolution: a part of the line is out of reach or singular.
        """
        T_start = flange_pose(arm, start_rad)
        distance_m = float(np.linalg.norm(T_base_flange[:3, 3] - T_start[:3, 3]))
        turn = vector_from_rotation(T_start[:3, :3].T @ T_base_flange[:3, :3])
        angle_rad = float(np.linalg.norm(turn))
        self._profile = Trapezoid(max(distance_m, angle_rad), speed_m_s, acceleration_m_s2)
        self.duration_s = self._profile.duration_s
        n = 1 + int(np.ceil(max(distance_m / _SAMPLE_M, angle_rad / _SAMPLE_RAD, 1)))
        self._shares = np.linspace(0, 1, n)
        poses = np.tile(np.eye(4), (n, 1, 1))
        poses[:, :3, 3] = T_start[:3, 3] + self._shares[:, None] * (T_base_flange[:3, 3] - T_start[:3, 3])
        poses[:, :3, :3] = [T_start[:3, :3] @ rotation_from_vector(share * turn) for share in self._shares]
        self._joints = _along(arm, start_rad, poses)
        self.end_rad = self._joints[-1]

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints, their speeds, and the share of the way."""
        position, speed = self._profile.at(time_s)
        if not self._profile.length or time_s >= self.duration_s:
            return self.end_rad, np.zeros(6), 1.0
        share = position / self._profile.length
        k = min(int(share * (len(self._shares) - 1)), len(self._shares) - 2)
        step = self._joints[k + 1] - self._joints[k]
        within = share * (len(self._shares) - 1) - k
        slope = step * (len(self._shares) - 1) / self._profile.length
        return self._joints[k] + within * step, slope * speed, share


def _along(arm: ArmModel, start_rad: FloatArray, poses: FloatArray) -> FloatArray:
    """Follow flange poses (N, 4, 4) from a configuration on, in one branch: joints (N, 6)."""
    branches = inverse_kinematics(arm, poses)
    joints = np.empty((len(poses), 6))
    last = start_rad
    for k, (candidates, found) in enumerate(zip(branches.joints_rad, branches.found, strict=True)):
        near = nearest_turn(arm, candidates[found], last)
        steps = np.abs(near - last).max(axis=-1, initial=0.0)
        if not len(near) or steps.min() > _LARGEST_STEP_RAD:
            raise NoSolution("a part of the line cannot be reached")
        last = joints[k] = near[steps.argmin()]
    return joints
