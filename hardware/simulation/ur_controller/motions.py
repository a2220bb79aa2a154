"""What moves the arm: trajectories known from start to end, and targets that are followed.

A trajectory gives the joints at any time after its start: braking, a straight line in space. Straight joint
moves are `hardware.robots.joint_motion.JointMotion`, paths with blends are `path_script.BlendedPath`.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose, inverse_kinematics, jacobian, nearest_turn
from hardware.robots.joint_motion import Trapezoid
from hardware.robots.ur.pose_vectors import rotation_from_vector, vector_from_rotation

_SAMPLE_M = 0.002
_SAMPLE_RAD = 0.01
"""Between two samples of a straight line, the joints move evenly."""
_LARGEST_STEP_RAD = 0.3
"""A joint that would turn more between two samples passes a singularity or changes its branch."""


class NoSolution(Exception):
    """No configuration brings the tool there; the real controller ends the program with this."""


class Trajectory(Protocol):
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
        rotation_rad = vector_from_rotation(T_start[:3, :3].T @ T_base_flange[:3, :3])
        angle_rad = float(np.linalg.norm(rotation_rad))
        self._profile = Trapezoid(max(distance_m, angle_rad), speed_m_s, acceleration_m_s2)
        self.duration_s = self._profile.duration_s
        n = 1 + int(np.ceil(max(distance_m / _SAMPLE_M, angle_rad / _SAMPLE_RAD, 1)))
        self._shares = np.linspace(0, 1, n)
        poses = np.tile(np.eye(4), (n, 1, 1))
        poses[:, :3, 3] = T_start[:3, 3] + self._shares[:, None] * (T_base_flange[:3, 3] - T_start[:3, 3])
        poses[:, :3, :3] = [
            T_start[:3, :3] @ rotation_from_vector(share * rotation_rad) for share in self._shares
        ]
        self._joints = _along(arm, start_rad, poses)
        self.end_rad = self._joints[-1]

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints, their speeds, and the share of the path."""
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


class PlannedMotion:
    """Runs along a trajectory.

    Attributes:
        joints_rad, speeds_rad_s, is_done, is_paced: as in `Motion`.
        time_s: how long it has run.
    """

    def __init__(self, trajectory: Trajectory, is_paced: bool = True) -> None:
        """Begin at its start."""
        self.is_paced = is_paced
        self.time_s = 0.0
        self._trajectory = trajectory
        self.advance(0.0)

    def advance(self, dt_s: float) -> None:
        """Go on by a time."""
        self.time_s += dt_s
        self.joints_rad, self.speeds_rad_s, _ = self._trajectory.at(self.time_s)
        self.is_done = self.time_s >= self._trajectory.duration_s


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
