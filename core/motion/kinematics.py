"""Forward and inverse kinematics of UR arms, the Jacobian, and joint angles that differ by whole turns.

All but `joint_poses` know an arm's own calibration; the inverse refines the published arm's solution by it.

Functions of configurations take any leading shape: (6,), (N, 6), (N, 8, 6). The inverse is closed-form, all
branches of many poses at once: shoulder left or right, wrist flipped or not, elbow up or down. The order of
its solution (joints 1, 5, 6, then the planar arm 2, 3, 4) is the usual one for this geometry, for example
Hawkins, "Analytic Inverse Kinematics for the Universal Robots UR-5/UR-10 Arms", 2013.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.arm_models import ArmModel

TURN_RAD = 2 * np.pi
N_JOINTS = 6
_LIMIT_TOLERANCE_RAD = 1e-9
"""So that a joint exactly at its limit is inside."""
N_BRANCHES = 8
_SIGNS = tuple(product((1, -1), repeat=3))
"""Shoulder, wrist and elbow of each branch."""
_SAME_RAD = 1e-6
"""Branches that are nearer to each other are one: they merge where the arm is stretched."""
_WRIST_SINE = 1e-6
"""Below this sine of joint 5, the axes of joints 4 and 6 count as parallel."""
_COSINE_TOLERANCE = 1e-9
"""A cosine this much beyond 1 is rounding at the edge of the reach, not a pose out of reach."""
_POSE_TOLERANCE = 1e-6
_NEWTON_STEPS = 4
"""From the published arm's solution, millimetres away; each step about squares what is left."""
_DAMPING = 1e-9
"""Keeps a step near a singular configuration small, and elsewhere hardly differs from none."""


def link_poses(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Poses `T_base_link` (..., 7, 4, 4) of the base (0) and of the six links' frames; the last is the
    flange.

    Args:
        arm: its Denavit-Hartenberg parameters.
        joints_rad: (..., 6).
    """
    joints = np.asarray(joints_rad, dtype=float)
    steps = joint_poses(arm.a_m, arm.d_m, arm.alpha_rad, joints)
    if arm.corrections:
        steps = steps @ _corrections(arm)
    poses = np.empty((*joints.shape[:-1], N_JOINTS + 1, 4, 4))
    poses[..., 0, :, :] = np.eye(4)
    for k in range(N_JOINTS):
        np.matmul(poses[..., k, :, :], steps[..., k, :, :], out=poses[..., k + 1, :, :])
    return poses


def _corrections(arm: ArmModel) -> FloatArray:
    """The poses (6, 4, 4) that an arm's own calibration adds behind its links."""
    poses = np.tile(np.eye(4), (N_JOINTS, 1, 1))
    poses[:, :3] = arm.corrections
    return poses


def joint_poses(
    a_m: npt.ArrayLike, d_m: npt.ArrayLike, alpha_rad: npt.ArrayLike, angle_rad: FloatArray
) -> FloatArray:
    """Poses (..., 4, 4) of link frames in the frames before them, for Denavit-Hartenberg parameters that
    broadcast against the joints' angles (...).
    """
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    ca, sa, a = np.cos(alpha_rad), np.sin(alpha_rad), np.asarray(a_m)
    poses = np.zeros((*angle_rad.shape, 4, 4))
    poses[..., 0, 0], poses[..., 0, 1], poses[..., 0, 2], poses[..., 0, 3] = c, -s * ca, s * sa, a * c
    poses[..., 1, 0], poses[..., 1, 1], poses[..., 1, 2], poses[..., 1, 3] = s, c * ca, -c * sa, a * s
    poses[..., 2, 1], poses[..., 2, 2], poses[..., 2, 3], poses[..., 3, 3] = sa, ca, d_m, 1
    return poses


def flange_pose(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Pose `T_base_flange` (..., 4, 4) at configurations (..., 6)."""
    return link_poses(arm, joints_rad)[..., N_JOINTS, :, :]


def jacobian(arm: ArmModel, joints_rad: npt.ArrayLike) -> FloatArray:
    """Geometric Jacobian (..., 6, 6): joint speeds to the flange's linear (m/s) and angular velocity (rad/s).

    Both are in the base frame; the linear velocity is that of the flange frame's origin.
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

    A joint that no number of turns brings within the limits stays outside; see `within_limits`.

    Args:
        arm: its limits.
        joints_rad: (..., 6).
        reference_rad: (..., 6), broadcast against the configurations.
    """
    joints, reference = np.asarray(joints_rad, dtype=float), np.asarray(reference_rad, dtype=float)
    nearest = joints + TURN_RAD * np.round((reference - joints) / TURN_RAD)
    too_high = nearest > np.array(arm.upper_rad) + _LIMIT_TOLERANCE_RAD
    too_low = nearest < np.array(arm.lower_rad) - _LIMIT_TOLERANCE_RAD
    turned: FloatArray = nearest - TURN_RAD * too_high + TURN_RAD * too_low
    return turned


@dataclass(frozen=True)
class InverseBranches:
    """All configurations that bring the flange to N poses; 8 branches, or the requested ones.

    Attributes:
        joints_rad: (N, 8, 6), each joint within half a turn of 0; zeros where there is no branch.
        found: (N, 8) whether there is a branch; each was verified by forward kinematics (1e-6 m, 1e-6 rad).
        undetermined: (N, 8) whether the pose is wrist-singular in this branch: joint 6 is arbitrary,
            compensated by joints 2 to 4. The branch given is the one with joint 6 at 0, if there is
            one.
    """

    joints_rad: FloatArray
    found: BoolArray
    undetermined: BoolArray


def inverse_kinematics(
    arm: ArmModel, T_base_flange: FloatArray, branches: Sequence[int] = range(N_BRANCHES)
) -> InverseBranches:
    """Find branches for poses (N, 4, 4); a pose out of reach has none, a singular one is marked.

    Args:
        arm: its kinematics.
        T_base_flange: (N, 4, 4).
        branches: which ones, 0 to 7; `branch_of` returns that of a configuration.
    """
    n = len(T_base_flange)
    joints = np.zeros((n, len(branches), 6))
    found = np.zeros((n, len(branches)), dtype=bool)
    undetermined = np.zeros((n, len(branches)), dtype=bool)
    for k, branch in enumerate(branches):
        joints[:, k], found[:, k], undetermined[:, k] = _branch(arm, T_base_flange, *_SIGNS[branch])
    if arm.corrections:
        joints[found] = _refined(arm, joints[found], T_base_flange[found.nonzero()[0]])
    found &= _reaches(arm, joints, T_base_flange)
    joints[~found] = 0
    return InverseBranches(joints, found, undetermined)


def _refined(arm: ArmModel, joints_rad: FloatArray, T_base_flange: FloatArray) -> FloatArray:
    """Bring the published arm's configurations (K, 6) to poses (K, 4, 4) by the arm's own kinematics."""
    for _ in range(_NEWTON_STEPS):
        error = _twist(flange_pose(arm, joints_rad), T_base_flange)[..., None]
        J = jacobian(arm, joints_rad)
        Jt = np.swapaxes(J, -1, -2)
        step = np.linalg.solve(Jt @ J + _DAMPING * np.eye(N_JOINTS), Jt @ error)
        joints_rad = joints_rad + step[..., 0]
    return wrapped(joints_rad)


def _twist(here: FloatArray, there: FloatArray) -> FloatArray:
    """The small shift and rotation (K, 6), in the base frame, from poses (K, 4, 4) to others."""
    turn = np.cross(here[:, :3, :3], there[:, :3, :3], axis=1).sum(axis=2) / 2
    return np.concatenate([there[:, :3, 3] - here[:, :3, 3], turn], axis=1)


def configurations(arm: ArmModel, T_base_flange: FloatArray) -> FloatArray:
    """Return the different configurations (K, 6), K from 0 to 8, for one pose (4, 4)."""
    branches = inverse_kinematics(arm, T_base_flange[None])
    different: list[FloatArray] = []
    for joints in branches.joints_rad[0, branches.found[0]]:
        if all(np.abs(wrapped(joints - other)).max() > _SAME_RAD for other in different):
            different.append(joints)
    return np.array(different).reshape(-1, 6)


def branch_of(arm: ArmModel, joints_rad: npt.ArrayLike) -> IntArray:
    """Return on which branch (...), 0 to 7, configurations (..., 6) are; a singular one is on either.

    The factors of the Jacobian's determinant change sign between the branches: the side of the base's axis on
    which the wrist is, the sine of joint 5, and the sine of joint 3.
    """
    joints = np.asarray(joints_rad, dtype=float)
    flange = flange_pose(arm, joints)
    center = flange[..., :3, 3] - arm.d_m[5] * flange[..., :3, 2]
    ahead = center[..., 0] * np.cos(joints[..., 0]) + center[..., 1] * np.sin(joints[..., 0])
    shoulder, wrist, elbow = ahead < 0, np.sin(joints[..., 4]) < 0, np.sin(joints[..., 2]) < 0
    return np.asarray(4 * shoulder + 2 * wrist + elbow, dtype=np.int64)


def _branch(
    arm: ArmModel, T: FloatArray, shoulder: int, wrist: int, elbow: int
) -> tuple[FloatArray, BoolArray, BoolArray]:
    """One branch by its three signs: joints (N, 6), whether it exists (N,), whether joint 6 is free (N,)."""
    joint1, reaches_shoulder = _joint1(arm, T, shoulder)
    joint5, joint6, is_free = _joints_5_6(T, joint1, wrist)
    T_0_1, T_4_5, T_5_6 = (
        joint_poses(arm.a_m[k], arm.d_m[k], arm.alpha_rad[k], angle)
        for k, angle in ((0, joint1), (4, joint5), (5, joint6))
    )
    T_1_4 = np.linalg.inv(T_0_1) @ T @ np.linalg.inv(T_4_5 @ T_5_6)
    joint2, joint3, joint4, reaches_elbow = _planar_joints(arm, T_1_4, elbow)
    joints = np.stack([joint1, joint2, joint3, joint4, joint5, joint6], axis=-1)
    return wrapped(joints), reaches_shoulder & reaches_elbow, is_free


def _joint1(arm: ArmModel, T: FloatArray, shoulder: int) -> tuple[FloatArray, BoolArray]:
    """The vertical plane of the arm passes the wrist's center at the distance d4."""
    wrist_center = T[:, :3, 3] - arm.d_m[5] * T[:, :3, 2]
    distance = np.hypot(wrist_center[:, 0], wrist_center[:, 1])
    sine = arm.d_m[3] / np.maximum(distance, 1e-12)
    aside = np.arcsin(np.minimum(sine, 1))
    towards = np.arctan2(wrist_center[:, 1], wrist_center[:, 0])
    joint1 = towards + (aside if shoulder > 0 else np.pi - aside)
    return joint1, sine <= 1 + _COSINE_TOLERANCE


def _joints_5_6(T: FloatArray, joint1: FloatArray, wrist: int) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Joint 2's axis, seen from the flange, determines joints 5 and 6."""
    axis2 = np.stack([np.sin(joint1), -np.cos(joint1), np.zeros_like(joint1)], axis=-1)
    in_flange = np.einsum("nij,ni->nj", T[:, :3, :3], axis2)
    sine = np.hypot(in_flange[:, 0], in_flange[:, 1])
    is_free = sine < _WRIST_SINE
    joint5 = wrist * np.arctan2(sine, in_flange[:, 2])
    joint6 = np.arctan2(-wrist * in_flange[:, 1], wrist * in_flange[:, 0])
    return joint5, np.where(is_free, 0.0, joint6), is_free


def _planar_joints(
    arm: ArmModel, T_1_4: FloatArray, elbow: int
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Joints 2, 3 and 4 are a planar arm of two links that carries the wrist."""
    a2, a3 = arm.a_m[1], arm.a_m[2]
    x, y = T_1_4[:, 0, 3], T_1_4[:, 1, 3]
    cosine = (x**2 + y**2 - a2**2 - a3**2) / (2 * a2 * a3)
    joint3 = elbow * np.arccos(np.clip(cosine, -1, 1))
    joint2 = np.arctan2(y, x) - np.arctan2(a3 * np.sin(joint3), a2 + a3 * np.cos(joint3))
    together = np.arctan2(T_1_4[:, 1, 0], T_1_4[:, 0, 0])
    return joint2, joint3, together - joint2 - joint3, np.abs(cosine) <= 1 + _COSINE_TOLERANCE


def wrapped(angle_rad: FloatArray) -> FloatArray:
    """The same angles in [-pi, pi]."""
    return angle_rad - TURN_RAD * np.round(angle_rad / TURN_RAD)


def _reaches(arm: ArmModel, joints: FloatArray, T_base_flange: FloatArray) -> BoolArray:
    """Which (N, 8) configurations (N, 8, 6) bring the flange to its pose (N, 4, 4)."""
    error = np.abs(flange_pose(arm, joints) - T_base_flange[:, None])
    reaches: BoolArray = error.max(axis=(-1, -2)) < _POSE_TOLERANCE
    return reaches
