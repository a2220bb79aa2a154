"""A person who guides a simulated arm's hand until the tip of its tool is on a corner of the board."""

from __future__ import annotations

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose, inverse_kinematics
from hardware.simulation.set_up import SetUp

_TURNS = [
    np.diag([1.0, -1.0, -1.0]) @ rotation_z(yaw_rad)
    for yaw_rad in np.linspace(0, 2 * np.pi, 12, endpoint=False)
]
"""The hand points down, turned about the vertical in every way."""
_STEPS = 5


def joints_on_point(
    arm: ArmModel, set_up: SetUp, tip_m: FloatArray, point_m: FloatArray, random: np.random.Generator
) -> FloatArray:
    """Return joints (6,) by which this very arm, with its errors, has its tip on a point, pointing down.

    Args:
        arm: as its maker publishes it.
        set_up: what arm it really is.
        tip_m: (3,) the tip in the flange frame.
        point_m: (3,) in the base frame.
        random: how the arm flexes there.

    Raises:
        MotionError: the arm does not reach it.
    """
    own, flexing = set_up.own_arm(arm), set_up.flexed(np.eye(4), random)
    for turn in _TURNS:
        aim_m = point_m
        for _ in range(_STEPS):
            found = inverse_kinematics(arm, make_pose(turn, aim_m - turn @ tip_m)[None])
            if not found.found.any():
                break
            joints_rad = found.joints_rad[0, int(found.found[0].argmax())]
            tip_there_m = transform_points(flange_pose(own, joints_rad) @ flexing, tip_m)
            aim_m = aim_m + point_m - tip_there_m
        else:
            return np.asarray(joints_rad)
    raise MotionError("The simulated arm does not reach this corner of the board with the tip of its tool.")
