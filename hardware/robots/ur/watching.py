"""Whether a moving arm does what it should, judged at every state; in the worker, next to the controller."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.joint_path import JOINT_NAMES
from hardware.errors import (
    EmergencyStop,
    ProgramStopped,
    ProtectiveStop,
    RobotError,
    RobotNotReady,
    TrackingLost,
)
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.mailbox import RUNTIME_PLAYING, robot_mode, safety_mode

TRACKING_RAD = 0.05
"""How far a joint may be from where the controller wants it, and from the way it was asked to go."""

_EMERGENCY = (SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP)


def unsafe(raw: AnyArray) -> RobotError | None:
    """What of the safety system or of the arm's power forbids motion, at a state of `FIELDS`."""
    safety, mode = safety_mode(raw), robot_mode(raw)
    if safety in _EMERGENCY:
        return EmergencyStop(
            "An emergency stop is pressed; see that all is safe, release it and recover the robot."
        )
    if safety is SafetyMode.PROTECTIVE_STOP:
        return ProtectiveStop(
            "The controller made a protective stop; see what the arm touched or what was too fast for it, "
            "then recover the robot."
        )
    if not safety.may_move:
        return RobotNotReady(
            f"The safety system is in '{safety.words}' and lets the arm not move; put that right at the "
            "robot's panel, then recover the robot."
        )
    if mode is not RobotMode.RUNNING:
        return RobotNotReady(
            f"The arm is in '{mode.words}', so its brakes hold or its power is off; recover the robot to "
            "switch it on, when nobody is near."
        )
    return None


def deviation(raw: AnyArray) -> RobotError | None:
    """What is wrong with a state of a moving arm, the gravest first."""
    grave = unsafe(raw)
    if grave is not None:
        return grave
    if int(raw["runtime_state"]) != RUNTIME_PLAYING:
        return ProgramStopped(
            "The control program on the robot was stopped or paused, at its panel or by another program; "
            "see why, then recover the robot and plan anew."
        )
    return tracking_lost(raw["joints_rad"], raw["target_joints_rad"][None], "where the controller wants it")


def tracking_lost(joints_rad: FloatArray, asked_rad: FloatArray, what: str) -> TrackingLost | None:
    """Say so when joints (6,) are farther than `TRACKING_RAD` from every one of the places (N, 6)."""
    apart = np.abs(asked_rad - joints_rad)
    nearest = apart[apart.max(axis=1).argmin()]
    if nearest.max() <= TRACKING_RAD:
        return None
    return TrackingLost(
        f"The {JOINT_NAMES[int(nearest.argmax())]} joint was {np.degrees(nearest.max()):.1f} degrees from "
        f"{what} and the arm was stopped; see what holds or pushes it, then recover the robot and plan anew."
    )
