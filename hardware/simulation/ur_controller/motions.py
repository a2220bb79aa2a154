"""What moves the arm at each moment: a course that runs off, or a target that is followed."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import jacobian
from hardware.simulation.ur_controller.courses import Course

_SERVO_ACCELERATION_RAD_S2 = 40.0
"""UR publishes none for servoj; the joints of a UR5 reach about this much."""
_USUAL_GAIN = 300.0
_DAMPING = 1e-3
"""Keeps joint speeds finite where the arm is singular."""


class Motion(Protocol):
    """Something that moves the joints.

    Attributes:
        joints_rad: (6,) where they shall be now.
        speeds_rad_s: (6,) how fast they turn there.
        is_done: whether nothing more will happen.
        is_paced: whether the speed slider and a pause slow it down.
    """

    joints_rad: FloatArray
    speeds_rad_s: FloatArray
    is_done: bool
    is_paced: bool

    def advance(self, dt_s: float) -> None:
        """Go on by a time."""
        ...


class CourseMotion:
    """Runs a course off.

    Attributes:
        joints_rad, speeds_rad_s, is_done, is_paced: as in `Motion`.
        time_s: how long it has run.
    """

    def __init__(self, course: Course, is_paced: bool = True) -> None:
        """Stand at its start."""
        self.is_paced = is_paced
        self.time_s = 0.0
        self._course = course
        self.advance(0.0)

    def advance(self, dt_s: float) -> None:
        """Go on by a time."""
        self.time_s += dt_s
        self.joints_rad, self.speeds_rad_s, _ = self._course.at(self.time_s)
        self.is_done = self.time_s >= self._course.duration_s


class ServoMotion:
    """Follows a joint target that a client keeps moving (servoj).

    The real law is not published. Here the joint speed aims at the target within the look-ahead time, faster
    with more gain, within the joints' speed and acceleration: a steadily moving target is followed late by
    the look-ahead time.

    Attributes:
        joints_rad, speeds_rad_s, is_done, is_paced: as in `Motion`.
    """

    is_done = False
    is_paced = True

    def __init__(self, arm: ArmModel, joints_rad: FloatArray, speeds_rad_s: FloatArray) -> None:
        """Begin where the joints are, holding that place."""
        self.joints_rad, self.speeds_rad_s = joints_rad, speeds_rad_s
        self._limits = np.array(arm.speed_limits_rad_s)
        self.aim(joints_rad, 0.1, _USUAL_GAIN)

    def aim(self, target_rad: FloatArray, lookahead_s: float, gain: float) -> None:
        """Take a new target (6,)."""
        self._target = target_rad
        self._rate_hz = max(gain, 1.0) / _USUAL_GAIN / max(lookahead_s, 1e-3)

    def advance(self, dt_s: float) -> None:
        """Go on by a time."""
        if dt_s <= 0:
            return
        error = self._target - self.joints_rad
        wanted = error * (-np.expm1(-self._rate_hz * dt_s) / dt_s)
        # What can still be braked, cycle by cycle, before the target is passed.
        slowing = _SERVO_ACCELERATION_RAD_S2 * dt_s
        top = np.sqrt(slowing**2 / 4 + 2 * _SERVO_ACCELERATION_RAD_S2 * np.abs(error)) - slowing / 2
        top = np.minimum(self._limits, top)
        self.speeds_rad_s = _towards(self.speeds_rad_s, np.clip(wanted, -top, top), slowing)
        self.joints_rad = self.joints_rad + self.speeds_rad_s * dt_s


class SpeedMotion:
    """Turns the joints, or moves the tool, with a speed that a client sets (speedj, speedl).

    Attributes:
        joints_rad, speeds_rad_s, is_done, is_paced: as in `Motion`.
    """

    is_done = False
    is_paced = True

    def __init__(self, arm: ArmModel, joints_rad: FloatArray, speeds_rad_s: FloatArray) -> None:
        """Begin with the joints and speeds of now."""
        self.joints_rad, self.speeds_rad_s = joints_rad, speeds_rad_s
        self._arm = arm
        self._limits = np.array(arm.speed_limits_rad_s)
        self.aim(speeds_rad_s, 1.0, is_tool=False)

    def aim(self, speed: FloatArray, acceleration: float, is_tool: bool) -> None:
        """Take a new speed (6,): of the joints (rad/s), or of the flange (m/s, rad/s) in the base frame."""
        self._wanted, self._acceleration, self._is_tool = speed, acceleration, is_tool

    def advance(self, dt_s: float) -> None:
        """Go on by a time."""
        wanted, acceleration = self._wanted, self._acceleration
        if self._is_tool:
            J = jacobian(self._arm, self.joints_rad)
            wanted = J.T @ np.linalg.solve(J @ J.T + _DAMPING**2 * np.eye(6), wanted)
            # The tool's acceleration as the joints' at this place.
            acceleration *= max(np.abs(wanted).max() / max(np.abs(self._wanted).max(), 1e-9), 1e-3)
        wanted = np.clip(wanted, -self._limits, self._limits)
        self.speeds_rad_s = _towards(self.speeds_rad_s, wanted, acceleration * dt_s)
        self.joints_rad = self.joints_rad + self.speeds_rad_s * dt_s


def _towards(value: FloatArray, wanted: FloatArray, step: float) -> FloatArray:
    """Return a value (6,) nearer to the wanted one, no entry by more than a step."""
    nearer: FloatArray = value + np.clip(wanted - value, -step, step)
    return nearer
