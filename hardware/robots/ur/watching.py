"""Whether a moving arm does what it should, judged at every state; in the worker, next to the controller."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.joint_path import JOINT_NAMES
from hardware.errors import ProgramStopped, RobotError, TrackingLost
from hardware.readiness import unreadiness
from hardware.robots.ur.mailbox import RUNTIME_PLAYING, robot_mode, safety_mode

TRACKING_RAD = 0.05
"""How far a joint may be from where the controller wants it, and from the way it was asked to go."""


def unsafe(raw: AnyArray) -> RobotError | None:
    """What stands in the way of motion, for a state of `FIELDS`."""
    return unreadiness(safety_mode(raw), robot_mode(raw))


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
