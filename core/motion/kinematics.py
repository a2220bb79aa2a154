"""Forward kinematics, the Jacobian, and joint angles that differ by whole turns.

All functions take configurations of any leading shape: (6,), (N, 6), (N, 8, 6).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from core.geometry import BoolArray, FloatArray
from core.motion.arm_models import ArmModel

TURN_RAD = 2 * np.pi
N_JOINTS = 6
_LIMIT_TOLERANCE_RAD = 1e-9
"""So that a joint that stands exactly at its limit is inside."""


def link_poses(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Poses `T_base_link` (..., 7, 4, 4) of the base (0) and of the six links' frames; the last is the
    flange.

    Args:
        arm: whose Denavit-Hartenberg parameters.
        joints_rad: (..., 6).
    """
    joints = np.asarray(joints_rad, dtype=float)
    c, s = np.cos(joints), np.sin(joints)
    alpha = np.array(arm.alpha_rad)
    ca, sa, a = np.cos(alpha), np.sin(alpha), np.array(arm.a_m)
    steps = np.zeros((*joints.shape, 4, 4))
    steps[..., 0, 0], steps[..., 0, 1], steps[..., 0, 2], steps[..., 0, 3] = c, -s * ca, s * sa, a * c
    steps[..., 1, 0], steps[..., 1, 1], steps[..., 1, 2], steps[..., 1, 3] = s, c * ca, -c * sa, a * s
    steps[..., 2, 1], steps[..., 2, 2], steps[..., 2, 3], steps[..., 3, 3] = sa, ca, np.array(arm.d_m), 1
    poses = np.empty((*joints.shape[:-1], N_JOINTS + 1, 4, 4))
    poses[..., 0, :, :] = np.eye(4)
    for k in range(N_JOINTS):
        np.matmul(poses[..., k, :, :], steps[..., k, :, :], out=poses[..., k + 1, :, :])
    return poses


def joint_pose(arm: ArmModel, joint: int, angle_rad: npt.ArrayLike) -> FloatArray:
    """Pose (..., 4, 4) of link frame `joint + 1` in link frame `joint` (0 to 5), for angles (...)."""
    angle = np.asarray(angle_rad, dtype=float)
    c, s = np.cos(angle), np.sin(angle)
    ca, sa = np.cos(arm.alpha_rad[joint]), np.sin(arm.alpha_rad[joint])
    a = arm.a_m[joint]
    pose = np.zeros((*angle.shape, 4, 4))
    pose[..., 0, :] = np.stack([c, -s * ca, s * sa, a * c], axis=-1)
    pose[..., 1, :] = np.stack([s, c * ca, -c * sa, a * s], axis=-1)
    pose[..., 2, 1:] = sa, ca, arm.d_m[joint]
    pose[..., 3, 3] = 1
    return pose


def flange_pose(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Pose `T_base_flange` (..., 4, 4) at configurations (..., 6)."""
    return link_poses(arm, joints_rad)[..., N_JOINTS, :, :]


def jacobian(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Geometric Jacobian (..., 6, 6): joint speeds to the flange's velocity (m/s), then its turning (rad/s).

    Both are in the base frame, the velocity is that of the flange frame's origin.
    """
    poses = link_poses(arm, joints_rad)
    axes = poses[..., :N_JOINTS, :3, 2]
    arms = poses[..., N_JOINTS:, :3, 3] - poses[..., :N_JOINTS, :3, 3]
    columns = np.concatenate([np.cross(axes, arms), axes], axis=-1)
    return np.swapaxes(columns, -1, -2)


def singularity_measure(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """How far (...) configurations (..., 6) are from a singular one: the Jacobian's smallest singular value.

    With metres and radians as units it is 0 at a singular configuration and 0.27 at best on a UR5.
    """
    values = np.linalg.svd(jacobian(arm, joints_rad), compute_uv=False)
    return np.asarray(values[..., -1], dtype=float)


def within_limits(arm: ArmModel, joints_rad: npt.ArrayLike) -> BoolArray:
    """Which joints (..., 6) of configurations (..., 6) are within the arm's limits."""
    joints = np.asarray(joints_rad, dtype=float)
    low = joints >= np.array(arm.lower_rad) - _LIMIT_TOLERANCE_RAD
    inside: BoolArray = low & (joints <= np.array(arm.upper_rad) + _LIMIT_TOLERANCE_RAD)
    return inside


def nearest_turn(arm: ArmModel, joints_rad: npt.ArrayLike, reference_rad: npt.ArrayLike) -> FloatArray:
    """The same configurations (..., 6), each joint turned by whole turns to where it is nearest to a
    reference.

    A joint that no number of turns brings within the limits is left outside: ask `within_limits`.

    Args:
        arm: whose limits.
        joints_rad: (..., 6).
        reference_rad: (..., 6), broadcast against the configurations.
    """
    joints, reference = np.asarray(joints_rad, dtype=float), np.asarray(reference_rad, dtype=float)
    nearest = joints + TURN_RAD * np.round((reference - joints) / TURN_RAD)
    too_high = nearest > np.array(arm.upper_rad) + _LIMIT_TOLERANCE_RAD
    too_low = nearest < np.array(arm.lower_rad) - _LIMIT_TOLERANCE_RAD
    turned: FloatArray = nearest - TURN_RAD * too_high + TURN_RAD * too_low
    return turned
