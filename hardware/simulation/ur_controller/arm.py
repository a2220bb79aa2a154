"""The arm itself: where its joints are, what moves them, how it brakes, and what does not follow."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import ArmModel
from core.motion.kinematics import configurations, flange_pose, jacobian, nearest_turn, within_limits
from hardware.robots.ur.pose_vectors import pose_from_vector, vector_from_pose
from hardware.simulation.ur_controller.motions import (
    Braking,
    Motion,
    NoSolution,
    PlannedMotion,
    ServoMotion,
    SpeedMotion,
    Trajectory,
)

STOP_RAD_S2 = 10.0
"""How hard the controller brakes when a program or the power ends: from full speed in 0.3 s."""
_PACE_PER_S = 5.0
"""How fast a pause, a protective stop or the slider changes the pace: to rest in 0.2 s."""
_MOVING_RAD_S = 1e-4
_TOO_FAST = 1.02
"""A joint that catches up is allowed 1 % more than its limit."""
_STILL_RAD_S = np.zeros(6)
_STILL_RAD_S.flags.writeable = False


class Arm:
    """Six joints with a controller that wants them somewhere.

    Attributes:
        model: its kinematics.
        target_rad, target_speeds_rad_s: (6,) what the controller wants.
        joints_rad, speeds_rad_s: (6,) what is.
        T_flange_tcp: (4, 4) the tool, as set by the program.
        payload_kg, payload_center_m: what it carries, as set by the program; without effect.
        slider: share of the programmed speed, 0 to 1.
        is_held: whether a pause or a protective stop keeps the motion from going on.
        stuck: joints (0 to 5) that do not follow.
        safe_rad: (2, 6) the lowest and highest angles that the safety system allows.
        safe_speeds_rad_s: (6,) the highest speeds that it allows.
        safe_planes: normals (3,), and how far along them the tool may come, in metres.
    """

    def __init__(self, model: ArmModel, joints_rad: npt.ArrayLike) -> None:
        """Begin at rest."""
        self.model = model
        self.joints_rad = self.target_rad = np.array(joints_rad, dtype=float)
        self.speeds_rad_s = self.target_speeds_rad_s = _STILL_RAD_S
        self.T_flange_tcp = np.eye(4)
        self.payload_kg = 0.0
        self.payload_center_m = (0.0, 0.0, 0.0)
        self.slider = 1.0
        self.is_held = False
        self.stuck: set[int] = set()
        self.safe_rad = np.array([model.lower_rad, model.upper_rad])
        self.safe_planes: list[tuple[FloatArray, float]] = []
        self.safe_speeds_rad_s = np.array(model.speed_limits_rad_s)
        self._pace = 1.0
        self._motion: Motion | None = None
        self._next: Callable[[FloatArray], Trajectory] | None = None

    @property
    def is_idle(self) -> bool:
        """Whether nothing is left to be done."""
        return self._motion is None and self._next is None

    @property
    def is_moving(self) -> bool:
        """Whether the controller wants a joint to turn at this moment."""
        return bool(np.abs(self.target_speeds_rad_s).max() > _MOVING_RAD_S)

    @property
    def is_beyond_safety(self) -> bool:
        """Whether a joint is where the safety system does not allow it, or faster."""
        is_fast = bool((np.abs(self.speeds_rad_s) > _TOO_FAST * self.safe_speeds_rad_s).any())
        return is_fast or not self.is_safe(self.joints_rad)

    def is_safe(self, joints_rad: npt.ArrayLike) -> bool:
        """Whether the safety system allows a configuration (6,)."""
        low, high = self.safe_rad
        is_within = bool(((joints_rad >= low) & (joints_rad <= high)).all())
        if not self.safe_planes or not is_within:
            return is_within
        tool_m = (flange_pose(self.model, joints_rad) @ self.T_flange_tcp)[:3, 3]
        return all(normal @ tool_m <= offset_m for normal, offset_m in self.safe_planes)

    @property
    def is_paused(self) -> bool:
        """Whether a pause has brought it to rest."""
        return self.is_held and not self.is_moving

    @property
    def planned_time_s(self) -> float:
        """How long the present trajectory has run, in the program's own time; 0 where there is none."""
        if isinstance(self._motion, PlannedMotion) and self._next is None:
            return self._motion.time_s
        return 0.0

    def jump(self, joint: int, angle_rad: float) -> None:
        """Be elsewhere by a joint's angle, with the target: an encoder slipped, or a clamp."""
        slip = np.zeros(6)
        slip[joint] = angle_rad
        self.joints_rad, self.target_rad = self.joints_rad + slip, self.target_rad + slip
        if isinstance(self._motion, ServoMotion):
            self._motion.joints_rad = self.target_rad

    def run(self, make: Callable[[FloatArray], Trajectory]) -> None:
        """Begin a trajectory from rest, made for the joints (6,) where it begins; brake first if need be."""
        if self.is_moving:
            self.brake(STOP_RAD_S2)
            self._next = make
        else:
            self._motion, self._next = PlannedMotion(make(self.target_rad)), None

    def servo(self) -> ServoMotion:
        """Return the servo motion, begun if another one was going on."""
        if not isinstance(self._motion, ServoMotion):
            self._motion, self._next = ServoMotion(self.model, *self._now()), None
        return self._motion

    def speed(self) -> SpeedMotion:
        """Return the speed motion, begun if another one was going on."""
        if not isinstance(self._motion, SpeedMotion):
            self._motion, self._next = SpeedMotion(self.model, *self._now()), None
        return self._motion

    def brake(self, deceleration_rad_s2: float) -> None:
        """Stop what is going on, whatever the pace."""
        self._next = None
        braking = Braking(self.target_rad, self.target_speeds_rad_s, max(deceleration_rad_s2, 0.01))
        self._motion = PlannedMotion(braking, is_paced=False)

    def brake_tool(self, deceleration_m_s2: float) -> None:
        """Stop so that the tool slows down with a deceleration."""
        speed = float(np.linalg.norm(self.tcp_speed(self.target_rad, self.target_speeds_rad_s)[:3]))
        time_s = speed / max(deceleration_m_s2, 0.01)
        fastest = float(np.abs(self.target_speeds_rad_s).max())
        self.brake(fastest / time_s if time_s > 0 else STOP_RAD_S2)

    def step(self, dt_s: float) -> None:
        """Go on by one cycle."""
        wanted = 0.0 if self.is_held else self.slider
        self._pace += min(max(wanted - self._pace, -_PACE_PER_S * dt_s), _PACE_PER_S * dt_s)
        if self._motion is not None:
            pace = self._pace if self._motion.is_paced else 1.0
            self._motion.advance(dt_s * pace)
            self.target_rad = self._motion.joints_rad
            self.target_speeds_rad_s = self._motion.speeds_rad_s * pace
            if self._motion.is_done:
                self._motion = None
        elif self._next is not None and not self.is_held:
            self._motion, self._next = PlannedMotion(self._next(self.target_rad)), None
        self._follow(dt_s)

    def tcp_pose(self, joints_rad: FloatArray) -> FloatArray:
        """Return UR's pose vector (6,) of the tool."""
        return vector_from_pose(flange_pose(self.model, joints_rad) @ self.T_flange_tcp)

    def solve(self, pose: Sequence[float], near_rad: FloatArray) -> FloatArray:
        """Return the configuration (6,) nearest to another that brings the tool to a pose vector.

        Raises:
            NoSolution: out of reach, or exactly singular.
        """
        found = configurations(self.model, pose_from_vector(pose) @ invert_pose(self.T_flange_tcp))
        found = nearest_turn(self.model, found, near_rad)
        found = found[within_limits(self.model, found).all(axis=-1)]
        if not len(found):
            raise NoSolution("inverse kinematics: unable to find a solution")
        nearest: FloatArray = found[np.abs(found - near_rad).sum(axis=-1).argmin()]
        return nearest

    def has_solution(self, pose: Sequence[float], near_rad: FloatArray) -> bool:
        """Whether `solve` would find one."""
        try:
            self.solve(pose, near_rad)
        except NoSolution:
            return False
        return True

    def tcp_speed(self, joints_rad: FloatArray, speeds_rad_s: FloatArray) -> FloatArray:
        """Return the tool's linear and angular velocity (6,) in the base frame, m/s and rad/s."""
        if not speeds_rad_s.any():
            return np.zeros(6)
        speed: FloatArray = jacobian(self.model, joints_rad) @ speeds_rad_s
        lever = flange_pose(self.model, joints_rad)[:3, :3] @ self.T_flange_tcp[:3, 3]
        speed[:3] += np.cross(speed[3:], lever)
        return speed

    def _now(self) -> tuple[FloatArray, FloatArray]:
        return self.target_rad, self.target_speeds_rad_s

    def _follow(self, dt_s: float) -> None:
        """The joints are where they shall be, except stuck ones and those that were stuck a moment ago.

        Once the motion is over a joint that is elsewhere stays there: nothing leaps when it comes free.
        """
        if self.joints_rad is self.target_rad and self.speeds_rad_s is _STILL_RAD_S:
            return
        reach = np.array(self.model.speed_limits_rad_s) * dt_s * 1.01
        reach[list(self.stuck)] = 0.0
        step = np.clip(self.target_rad - self.joints_rad, -reach, reach)
        is_exact = not self.stuck and np.array_equal(self.joints_rad + step, self.target_rad)
        self.joints_rad = self.target_rad if is_exact else self.joints_rad + step
        self.speeds_rad_s = step / dt_s if step.any() else _STILL_RAD_S
        if self.is_idle and self.stuck:
            self.target_rad = self.joints_rad
