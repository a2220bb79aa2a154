"""The worker's states in the words of the robot interface."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry import AnyArray, FloatArray, make_pose
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from hardware.interfaces import RobotState
from hardware.robots.ur.mailbox import RUNTIME_PLAYING, robot_mode, safety_mode

_TOOL_OUTPUT_BIT = 16
"""Of the digital outputs 0-7 are the cabinet's, 8-15 configurable, 16 and 17 the tool's."""


def tool_vector(pose: FloatArray) -> list[float]:
    """Return a pose (4, 4) as the controller writes it: x, y, z in metres and a rotation vector."""
    turn = Rotation.from_matrix(pose[:3, :3]).as_rotvec()
    return [*pose[:3, 3].tolist(), *turn.tolist()]


def pose_of(vector: FloatArray) -> FloatArray:
    """Return the pose (4, 4) of what the controller writes (6,)."""
    return make_pose(Rotation.from_rotvec(vector[3:]).as_matrix(), vector[:3])


def robot_state(raw: AnyArray, arm: ArmModel) -> RobotState:
    """Return a state of `FIELDS` in the words of the interface."""
    bits = int(raw["output_bits"]) >> _TOOL_OUTPUT_BIT
    return RobotState(
        joints_rad=raw["joints_rad"],
        target_joints_rad=raw["target_joints_rad"],
        joint_speeds_rad_s=raw["joint_speeds_rad_s"],
        T_base_flange=flange_pose(arm, raw["joints_rad"]),
        T_base_tool=pose_of(raw["tool_pose"]),
        robot_mode=robot_mode(raw),
        safety_mode=safety_mode(raw),
        is_program_running=int(raw["runtime_state"]) == RUNTIME_PLAYING,
        tool_outputs=(bool(bits & 1), bool(bits & 2)),
        speed_scaling=float(np.clip(raw["speed_scaling"], 0.0, 1.0)),
        controller_s=float(raw["controller_s"]),
        time_s=float(raw["time_s"]),
    )
