"""Where a cup stands that the hand was guided to: its station, from the arm's joints."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose

MOST_TILT_RAD = np.radians(5.0)
"""The cup is taken upright; by hand an arm is not guided straighter than to some degrees."""


def taught_station_m(
    arm: ArmModel, joints_rad: npt.ArrayLike, T_flange_grasp: FloatArray, grip_height_m: float
) -> FloatArray:
    """Return the middle of the foot (3,) of a cup in the hand, in the base frame.

    Args:
        arm: its kinematics.
        joints_rad: (6,) where the hand holds the standing cup.
        T_flange_grasp: (4, 4) the tool frame, z along the cup's axis to its mouth.
        grip_height_m: the tool frame's origin above the cup's foot.

    Raises:
        MotionError: the cup in the hand would not stand upright.
    """
    T_base_grasp = flange_pose(arm, np.asarray(joints_rad, dtype=float)) @ T_flange_grasp
    tilt_rad = float(np.arccos(np.clip(T_base_grasp[2, 2], -1.0, 1.0)))
    if tilt_rad > MOST_TILT_RAD:
        raise MotionError(
            f"A cup in the hand would lean by {np.degrees(tilt_rad):.0f} degrees, and "
            f"{np.degrees(MOST_TILT_RAD):.0f} are allowed; guide the hand so that it holds the standing cup "
            "upright, then read again."
        )
    # straight down, not along the leaning axis: the cup that stands there is upright
    station: FloatArray = T_base_grasp[:3, 3] - [0.0, 0.0, grip_height_m]
    return station
