"""An arm's own kinematics, as its factory measured them, in place of the published ones.

The axes of joints 2, 3 and 4 are nearly parallel, so that a measured arm's Denavit-Hartenberg parameters may
hold offsets of hundreds of metres that cancel each other. Links are therefore described by how they differ
from the published ones, each frame being moved along its axis and turned about it to the published one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import ArmModel, JointValues, Row
from core.motion.kinematics import N_JOINTS, joint_poses

_MOST_M = 0.02
_MOST_RAD = 0.05
"""No link of an arm that is well differs by more from the published one: other models' links do."""
_NOTHING = 1e-8
"""In metres and radians; a simulated controller reports pi with nine decimals."""


@dataclass(frozen=True)
class MeasuredKinematics:
    """Denavit-Hartenberg parameters (classic convention) of one arm, as its controller holds them.

    Attributes:
        theta_rad: (6,) added to the joints' angles.
        a_m: (6,) link lengths.
        d_m: (6,) link offsets.
        alpha_rad: (6,) link twists.
        checksum: (6,) one of each joint, which tells two arms apart.
    """

    theta_rad: JointValues
    a_m: JointValues
    d_m: JointValues
    alpha_rad: JointValues
    checksum: tuple[int, ...]


def calibrated(arm: ArmModel, measured: MeasuredKinematics) -> ArmModel:
    """Return the model of an arm by its own kinematics; the published one if they do not differ.

    Raises:
        MotionError: they differ by more than one arm of a model does from another.
    """
    with np.errstate(all="ignore"):  # of numbers that are beyond all measure
        links = joint_poses(measured.a_m, measured.d_m, measured.alpha_rad, np.array(measured.theta_rad))
        corrections = _differences(links, joint_poses(arm.a_m, arm.d_m, arm.alpha_rad, np.zeros(N_JOINTS)))
        off_m, off_rad = _size(corrections)
    if not (off_m <= _MOST_M and off_rad <= _MOST_RAD):
        raise MotionError(
            f"it reports links that differ by up to {off_m * 1000:.0f} mm and "
            f"{np.degrees(off_rad):.1f} degrees from those of a {arm.name}"
        )
    if max(off_m, off_rad) < _NOTHING:
        return arm
    return replace(arm, corrections=tuple(_rows(pose) for pose in corrections.tolist()))


def _rows(pose: list[list[float]]) -> tuple[Row, Row, Row]:
    """The first three rows of a pose (4, 4)."""
    first, second, third = ((x, y, z, shift) for x, y, z, shift in pose[:3])
    return first, second, third


def _differences(links: FloatArray, published: FloatArray) -> FloatArray:
    """Poses (6, 4, 4) of an arm's link frames in the published ones, both (6, 4, 4) with joints at 0.

    A shift along a joint's axis and a rotation about it may be taken from one link and given to the next.
    """
    corrections = np.empty_like(links)
    given = np.eye(4)
    for k in range(N_JOINTS):
        corrections[k] = invert_pose(published[k]) @ given @ links[k]
        if k + 1 < N_JOINTS:
            taken = _along_and_about_z(corrections[k])
            corrections[k] = corrections[k] @ taken
            given = invert_pose(taken)
    return corrections


def _along_and_about_z(pose: FloatArray) -> FloatArray:
    """The shift along z and the rotation about it (4, 4) that bring a frame's pose nearest to none."""
    angle = np.arctan2(pose[0, 1] - pose[1, 0], pose[0, 0] + pose[1, 1])
    taken = np.eye(4)
    taken[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    taken[2, 3] = -pose[:3, 2] @ pose[:3, 3]
    return taken


def _size(corrections: FloatArray) -> tuple[float, float]:
    """The largest shift and the largest angle, as long as it is small, of poses (N, 4, 4)."""
    shifts_m = np.linalg.norm(corrections[:, :3, 3], axis=1)
    angles_rad = np.linalg.norm(corrections[:, :3, :3] - np.eye(3), axis=(1, 2)) / np.sqrt(2)
    return float(shifts_m.max()), float(angles_rad.max())
