"""Arms as factories build them: each axis a little beside where it was drawn."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics
from core.motion.kinematics import link_poses

CHECKSUM = (1, 2, 3, 4, 5, 6)


def measured_arm(
    arm: ArmModel, seed: int, off_m: float = 0.002, off_rad: float = 0.004
) -> MeasuredKinematics:
    """Move and tilt the published axes at random, and describe them as Denavit and Hartenberg do.

    Axes that are nearly parallel have their common normal far away, so that there are offsets of metres.
    """
    random = np.random.default_rng(seed)
    frames = link_poses(arm, np.zeros(6))
    origins, axes = frames[:6, :3, 3].copy(), frames[:6, :3, 2].copy()
    origins[1:] += random.uniform(-off_m, off_m, (5, 3))
    axes[1:] += random.uniform(-off_rad, off_rad, (5, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    x, foot, rows = frames[0, :3, 0], origins[0], []
    for here, there, origin in zip(axes, axes[1:], origins[1:], strict=False):
        normal, begin, end = _common_normal(foot, here, origin, there)
        along_m, offset_m = float((end - begin) @ normal), float((begin - foot) @ here)
        rows.append((_angle(x, normal, here), along_m, offset_m, _angle(here, there, normal)))
        x, foot = normal, end
    flange = frames[6]  # on the last axis, as controllers have it
    rows.append((_angle(x, flange[:3, 0], axes[5]), 0.0, float((flange[:3, 3] - foot) @ axes[5]), 0.0))
    theta, a, d, alpha = zip(*rows, strict=True)
    return MeasuredKinematics(theta, a, d, alpha, CHECKSUM)


def _common_normal(
    p: FloatArray, u: FloatArray, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Direction of the common normal of two lines, and its feet on them."""
    normal = np.cross(u, v)
    normal = normal / np.linalg.norm(normal)
    along_u, along_v, _ = np.linalg.solve(np.array([u, -v, normal]).T, q - p)
    return normal, p + along_u * u, q + along_v * v


def _angle(one: FloatArray, other: FloatArray, axis: FloatArray) -> float:
    return float(np.arctan2(np.cross(one, other) @ axis, one @ other))
