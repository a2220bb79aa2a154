"""Poses and rotations, in the words of robotics.

A pose `T_target_source` is a (4, 4) float64 matrix that takes points given in the source frame to the target
frame: `p_target = T_target_source @ p_source`. Quaternions are (x, y, z, w), as in PyBullet and SciPy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]
AnyArray = npt.NDArray[Any]


def make_pose(rotation: npt.ArrayLike, translation_m: npt.ArrayLike) -> FloatArray:
    """Put a (3, 3) rotation and a (3,) translation into a (4, 4) pose."""
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = translation_m
    return pose


def invert_pose(T_target_source: FloatArray) -> FloatArray:
    """Return `T_source_target`, using that the rotation is orthonormal."""
    rotation = T_target_source[:3, :3].T
    return make_pose(rotation, -rotation @ T_target_source[:3, 3])


def transform_points(T_target_source: FloatArray, points_m: npt.ArrayLike) -> FloatArray:
    """Take (..., 3) points from the source frame to the target frame."""
    moved: FloatArray = np.asarray(points_m, dtype=float) @ T_target_source[:3, :3].T + T_target_source[:3, 3]
    return moved


def rotation_x(angle_rad: float) -> FloatArray:
    """Rotation matrix (3, 3) about the x-axis."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]], dtype=float)


def rotation_y(angle_rad: float) -> FloatArray:
    """Rotation matrix (3, 3) about the y-axis."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]], dtype=float)


def rotation_z(angle_rad: float) -> FloatArray:
    """Rotation matrix (3, 3) about the z-axis."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], dtype=float)


def rotation_error(rotation: FloatArray) -> float:
    """How far a (3, 3) matrix is from a rotation: the largest entry of |R R^T - I|, or inf if mirrored."""
    if np.linalg.det(rotation) <= 0:
        return float("inf")
    return float(np.abs(rotation @ rotation.T - np.eye(3)).max())


def look_at(eye_m: npt.ArrayLike, target_m: npt.ArrayLike) -> FloatArray:
    """Pose `T_world_camera` of a camera at `eye_m` that looks at `target_m`.

    Optical frame: z forward, x to the right of the image, y down; the image's top points to world +z, or to
    world +y for a camera that looks straight down.
    """
    eye, target = np.asarray(eye_m, dtype=float), np.asarray(target_m, dtype=float)
    forward = (target - eye) / np.linalg.norm(target - eye)
    up = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    right = _cross(forward, up)
    right /= np.linalg.norm(right)
    return make_pose(np.column_stack([right, _cross(forward, right), forward]), eye)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The same bits as `np.cross` of two vectors (3,), which takes ten times as long for its generality."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def ellipsoid_inertia_kg_m2(mass_kg: float, diameter_m: float, height_m: float) -> FloatArray:
    """Principal moments (3,) of a solid ellipsoid; Bullet would take those of a box around it."""
    across_m, up_m = diameter_m / 2, height_m / 2
    about_x = (across_m**2 + up_m**2) / 5
    return mass_kg * np.array([about_x, about_x, 2 * across_m**2 / 5])
