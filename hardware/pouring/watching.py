"""Whether a moving arm is where the plan wants it, judged by what the controller reports."""

from __future__ import annotations

import numpy as np

from core.motion.trajectory import JointTrajectory
from hardware.errors import RobotLost, TrackingLost
from hardware.interfaces import RobotState
from hardware.readiness import unreadiness

MAX_AGE_S = 0.5
MAX_DEVIATION_RAD = 0.06
"""A servoed arm runs behind on its path, which is no deviation; beside it, it has no business."""


def refuse_unready(state: RobotState) -> None:
    """Refuse a state in which the arm must not be commanded.

    Raises:
        RobotError: its kind and sentence say why.
    """
    if state.age_s > MAX_AGE_S:
        raise RobotLost(
            f"The arm has told nothing for {state.age_s:.1f} s; look at it, and check its network cable."
        )
    unready = unreadiness(state.safety_mode, state.robot_mode)
    if unready is not None:
        raise unready


def refuse_deviation(state: RobotState, trajectory: JointTrajectory) -> None:
    """Refuse a state that lies beside the way.

    Raises:
        TrackingLost: a joint is too far from every place of the way.
    """
    beside_rad = np.abs(trajectory.joints_rad - state.joints_rad).max(axis=1)
    deviation_rad = float(beside_rad.min())
    if deviation_rad > MAX_DEVIATION_RAD:
        raise TrackingLost(
            f"The arm is {np.degrees(deviation_rad):.1f} degrees beside its planned way and was stopped; "
            "see what holds or pushes it."
        )
