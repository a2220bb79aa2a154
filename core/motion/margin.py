"""How far beside its planned path an arm may be before what was checked says nothing about it any more."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray
from core.motion.arm_models import FLANGE_LINK, ArmModel
from core.motion.clearance import MotionScene
from core.motion.kinematics import N_JOINTS, link_poses

SHARE_OF_CLEARANCE = 0.7
"""Of a motion's clearance; the rest is for what is not known of the arm's kinematics."""
_MOST_M = 0.01
"""No arm that is well leaves its path by more, however much room there is."""
_SHARES = np.linspace(0, 1, 17)[1:-1]
"""Of the way from sample to sample, so that their distance does not count."""
_MOST_SAMPLES = 60
"""Levers change slowly along a path."""


@dataclass(frozen=True)
class PathMargin:
    """What a motion's own clearance leaves for deviations from its path.

    Attributes:
        arm: its kinematics.
        links: (P,) frames that carry points of arm, tools and what is held: 0 (base) to 6 (flange).
        points_m: (P, 3) these points in their frames.
        levers_m: (6,) how far any of them moves at most, per radian of each joint.
        allowed_m: how far any of them may be from where it is planned.
    """

    arm: ArmModel
    links: IntArray
    points_m: FloatArray
    levers_m: FloatArray
    allowed_m: float

    def bound_m(self, joints_rad: FloatArray, path_rad: FloatArray) -> tuple[float, int]:
        """Return what an arm at (6,) is at most from one of the samples (N, 6) of a path, and from which."""
        bounds_m = np.abs(path_rad - joints_rad) @ self.levers_m
        nearest = int(bounds_m.argmin())
        return float(bounds_m[nearest]), nearest

    def beside_m(self, joints_rad: FloatArray, path_rad: FloatArray) -> float:
        """Return how far an arm at (6,) is from its place on a path (N, 6), densely sampled.

        It is the largest displacement of any point, as small as a moment of the path makes it; where it is
        allowed, a quick bound of it.
        """
        bound_m, nearest = self.bound_m(joints_rad, path_rad)
        if bound_m <= self.allowed_m:
            return bound_m
        around = path_rad[max(nearest - 1, 0) : nearest + 2]
        between = around[:-1, None] + _SHARES[:, None] * np.diff(around, axis=0)[:, None]
        moments = np.concatenate([around, between.reshape(-1, N_JOINTS)])
        poses = link_poses(self.arm, np.concatenate([joints_rad[None], moments]))[:, self.links]
        here_m, *moments_m = _placed_m(poses, self.points_m)
        apart_m = np.array(moments_m) - here_m
        return float(np.linalg.norm(apart_m, axis=-1).max(axis=1).min())


def path_margin(
    scene: MotionScene, joints_rad: FloatArray, clearance_m: float, held_m: FloatArray | None = None
) -> PathMargin:
    """Return the margin of a motion.

    Args:
        scene: arm and tools.
        joints_rad: (N, 6) samples of the motion.
        clearance_m: the smallest distance to anything during it.
        held_m: (P, 3) points of what is in the hand, in the flange's frame; none if it is empty.
    """
    capsules = scene.shape.capsules
    links = np.repeat([capsule.link for capsule in capsules], 2)
    points_m = np.array([end for capsule in capsules for end in (capsule.start_m, capsule.end_m)])
    radii_m = np.repeat(scene.radii_m, 2)
    if held_m is not None:
        links = np.concatenate([links, np.full(len(held_m), FLANGE_LINK)])
        points_m, radii_m = np.concatenate([points_m, held_m]), np.append(radii_m, np.zeros(len(held_m)))
    poses = link_poses(scene.arm, joints_rad[:: max(len(joints_rad) // _MOST_SAMPLES, 1)])
    placed_m = _placed_m(poses[:, links], points_m)
    levers_m = np.array(
        [
            (_from_axis_m(poses[:, joint], placed_m[:, moved]) + radii_m[moved]).max(initial=0.0)
            for joint in range(N_JOINTS)
            for moved in (links > joint,)
        ]
    )
    return PathMargin(scene.arm, links, points_m, levers_m, min(SHARE_OF_CLEARANCE * clearance_m, _MOST_M))


def _from_axis_m(T_base_link: FloatArray, points_m: FloatArray) -> FloatArray:
    """Distances (N, P) of points (N, P, 3) from the z-axes of frames (N, 4, 4)."""
    from_origin = points_m - T_base_link[:, None, :3, 3]
    return np.asarray(np.linalg.norm(np.cross(from_origin, T_base_link[:, None, :3, 2]), axis=-1))


def _placed_m(T_base_link: FloatArray, points_m: FloatArray) -> FloatArray:
    """Points (N, P, 3) in the base frame, of points (P, 3) in frames (N, P, 4, 4)."""
    rotated = np.einsum("npij,pj->npi", T_base_link[..., :3, :3], points_m)
    return np.asarray(rotated + T_base_link[..., :3, 3])
