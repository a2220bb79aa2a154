"""UR's pose vectors: position (m) and rotation vector (rad), against (4, 4) poses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, make_pose

_SMALL_RAD = 1e-12


def rotation_from_vector(vector_rad: npt.ArrayLike) -> FloatArray:
    """Rotation matrix (3, 3) of a rotation vector (3,), by Rodrigues' formula."""
    vector = np.asarray(vector_rad, dtype=float)
    angle = float(np.linalg.norm(vector))
    if angle < _SMALL_RAD:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: FloatArray = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def vector_from_rotation(rotation: FloatArray) -> FloatArray:
    """Rotation vector (3,) of a matrix (3, 3), at most half a turn long; sound near half a turn too."""
    # The largest of the four quaternion components, squared and times four, comes first: no small divisor.
    r = rotation
    squares = np.array([1 + r[0, 0] + r[1, 1] + r[2, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2],
                        1 - r[0, 0] + r[1, 1] - r[2, 2], 1 - r[0, 0] - r[1, 1] + r[2, 2]])  # fmt: skip
    rows = np.array([
        [squares[0], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], squares[1], r[1, 0] + r[0, 1], r[0, 2] + r[2, 0]],
        [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], squares[2], r[2, 1] + r[1, 2]],
        [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2], squares[3]],
    ])  # fmt: skip
    w, *axis = rows[squares.argmax()]
    sine = float(np.linalg.norm(axis))
    if sine < _SMALL_RAD:
        return np.zeros(3)
    angle = 2 * float(np.arctan2(sine, abs(w)))
    vector: FloatArray = np.array(axis) * (angle / sine if w >= 0 else -angle / sine)
    return vector


def pose_from_vector(vector: Sequence[float] | FloatArray) -> FloatArray:
    """Pose (4, 4) of UR's six numbers: metres, then a rotation vector in radians."""
    return make_pose(rotation_from_vector(vector[3:6]), vector[:3])


def vector_from_pose(pose: FloatArray) -> FloatArray:
    """UR's six numbers (6,) of a pose (4, 4)."""
    return np.concatenate([pose[:3, 3], vector_from_rotation(pose[:3, :3])])
