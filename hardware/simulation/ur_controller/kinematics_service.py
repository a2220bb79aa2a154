"""What a program asks of the controller's kinematics, in UR's pose vectors."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray, invert_pose
from core.motion.inverse_kinematics import configurations
from core.motion.kinematics import flange_pose, nearest_turn, within_limits
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.courses import NoSolution
from hardware.simulation.ur_controller.poses import pose_from_vector, vector_from_pose


def solve(arm: Arm, pose: list[float], near_rad: FloatArray) -> FloatArray:
    """Return the configuration (6,) nearest to another that brings the tool to a pose vector.

    Raises:
        NoSolution: out of reach, or exactly singular.
    """
    found = configurations(arm.model, pose_from_vector(pose) @ invert_pose(arm.T_flange_tcp))
    found = nearest_turn(arm.model, found, near_rad)
    found = found[within_limits(arm.model, found).all(axis=-1)]
    if not len(found):
        raise NoSolution("inverse kinematics: unable to find a solution")
    nearest: FloatArray = found[np.abs(found - near_rad).sum(axis=-1).argmin()]
    return nearest


def has_solution(arm: Arm, pose: list[float], near_rad: FloatArray) -> bool:
    """Whether `solve` would find one."""
    try:
        solve(arm, pose, near_rad)
    except NoSolution:
        return False
    return True


def forward(arm: Arm, joints_rad: FloatArray, tool: list[float]) -> FloatArray:
    """Return the pose vector (6,) of a tool, given in the flange frame, at a configuration."""
    return vector_from_pose(flange_pose(arm.model, joints_rad) @ pose_from_vector(tool))


def combine(first: list[float], second: list[float]) -> FloatArray:
    """Return the pose vector of one pose seen through another (pose_trans)."""
    return vector_from_pose(pose_from_vector(first) @ pose_from_vector(second))
