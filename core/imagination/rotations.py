"""Quaternions, (x, y, z, w) as in Bullet, without importing SciPy into every worker."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from core.geometry import AnyArray, FloatArray


def quaternion_of(rotation: FloatArray) -> FloatArray:
    """Return the quaternion (4,) of a rotation matrix (3, 3), by its largest component (Shepperd 1978)."""
    trace = np.trace(rotation)
    candidates = np.array([*rotation.diagonal(), trace])
    k = int(candidates.argmax())
    if k == 3:
        quaternion = np.array(
            [
                rotation[2, 1] - rotation[1, 2],
                rotation[0, 2] - rotation[2, 0],
                rotation[1, 0] - rotation[0, 1],
                1 + trace,
            ]
        )
    else:
        i, j, m = k, (k + 1) % 3, (k + 2) % 3
        quaternion = np.empty(4)
        quaternion[i] = 1 - trace + 2 * rotation[i, i]
        quaternion[j] = rotation[j, i] + rotation[i, j]
        quaternion[m] = rotation[m, i] + rotation[i, m]
        quaternion[3] = rotation[m, j] - rotation[j, m]
    unit: FloatArray = quaternion / np.linalg.norm(quaternion)
    return unit


def multiply_quaternions(left: AnyArray, right: AnyArray) -> FloatArray:
    """Return the Hamilton product of (..., 4) quaternions: first `right`, then `left`."""
    lx, ly, lz, lw = np.moveaxis(left, -1, 0)
    rx, ry, rz, rw = np.moveaxis(right, -1, 0)
    return np.stack(
        [
            lw * rx + lx * rw + ly * rz - lz * ry,
            lw * ry - lx * rz + ly * rw + lz * rx,
            lw * rz + lx * ry - ly * rx + lz * rw,
            lw * rw - lx * rx - ly * ry - lz * rz,
        ],
        axis=-1,
    )


def yaw_quaternion(angle_rad: float) -> FloatArray:
    """Return the quaternion (4,) of a rotation about z."""
    return np.array([0.0, 0.0, sin(angle_rad / 2), cos(angle_rad / 2)])
