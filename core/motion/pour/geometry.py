"""Where hand and cup are in each segment of a pour: poses of the tool frame (Sec. III-B, Eq. 6).

The cup is round, so it may sit in the hand at any angle psi about its axis: psi is where on its rim, seen
from the hand, the pivot is. While the cup is upright, one azimuth gives the hand's orientation: that of the
tool frame's x-axis in the base frame.
"""

from __future__ import annotations

from math import pi

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_z
from core.imagination.cup import cup_pose, inner_radius_m, pivot_in_cup_m, pour_angle
from core.motion.distances import Cone
from core.motion.pour.plan import PourTarget
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters


def outer_cone(cup: CupParameters) -> Cone:
    """The cup's outside, closed, in the cup's frame; the same as in the imagination."""
    return Cone(float(inner_radius_m(cup, 0.0)) + cup.wall_m, cup.mouth_radius_m, cup.length_m)


def grasp_of_cup(psi_rad: float, grip_height_m: float) -> FloatArray:
    """`T_grasp_cup` (4, 4): gripped at a height above its base, the pivot at the angle psi."""
    return make_pose(rotation_z(psi_rad), (0.0, 0.0, -grip_height_m))


def hand_angle_rad(T_flange_grasp: FloatArray) -> float:
    """The angle about the cup's axis, in the tool frame, in which the hand points.

    With the pivot there, the hand is opposite to it: above the cup that is tilted ready to pour.
    """
    flange_z = T_flange_grasp[2, :3]
    return float(np.arctan2(flange_z[1], flange_z[0]))


def upright_rad(cup: CupParameters) -> float:
    """The pour angle gamma, below zero, at which the cup stands upright."""
    return cup.slant_rad - pi / 2


def upright_azimuth_rad(theta_rad: float, psi_rad: float) -> float:
    """The hand's azimuth when the cup of a pour has been rotated upright about the pour's axis."""
    return theta_rad + pi - psi_rad


def upright_grasps(positions_m: FloatArray, azimuths_rad: FloatArray) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) with the cup upright, at positions (N, 3) and azimuths (N,)."""
    poses = np.tile(np.eye(4), (len(positions_m), 1, 1))
    c, s = np.cos(azimuths_rad), np.sin(azimuths_rad)
    poses[:, 0, 0], poses[:, 0, 1], poses[:, 1, 0], poses[:, 1, 1] = c, -s, s, c
    poses[:, :3, 3] = positions_m
    return poses


def rotated_cups(
    cup: CupParameters, pivot_m: FloatArray, theta_rad: float, gamma_rad: FloatArray
) -> FloatArray:
    """`T_base_cup` (N, 4, 4) rotated by gamma (N,) about the pour's axis, with the pivot in its place.

    The same poses as those of `cup_pose`, which returns one at a time.
    """
    ready = cup_pose(cup, np.zeros(3), theta_rad, 0.0)[:3, :3]
    axis = rotation_z(theta_rad)[:, 1]
    along = np.outer(axis, axis)
    across = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    c, s = np.cos(gamma_rad)[:, None, None], np.sin(-gamma_rad)[:, None, None]
    rotations = (c * np.eye(3) + (1 - c) * along + s * across) @ ready
    poses = np.tile(np.eye(4), (len(gamma_rad), 1, 1))
    poses[:, :3, :3] = rotations
    poses[:, :3, 3] = pivot_m - rotations @ pivot_in_cup_m(cup)
    return poses


def tilted_grasps(
    cup: CupParameters, theta_rad: float, gamma_rad: FloatArray, psi_rad: FloatArray, positions_m: FloatArray
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at positions (N, 3), the cup tilted by gamma (N,) in the direction of a pour.

    The hand may rotate about the cup's axis meanwhile, psi (N,), which leaves cup and candies as they are.
    """
    poses = rotated_cups(cup, np.zeros(3), theta_rad, gamma_rad)
    c, s = np.cos(psi_rad), np.sin(psi_rad)
    back = np.zeros((len(psi_rad), 3, 3))
    back[:, 0, 0], back[:, 0, 1], back[:, 1, 0], back[:, 1, 1], back[:, 2, 2] = c, s, -s, c, 1
    poses[:, :3, :3] = poses[:, :3, :3] @ back
    poses[:, :3, 3] = positions_m
    return poses


def tilting_grasps(
    target: PourTarget,
    psi_rad: float,
    upright_m: FloatArray,
    spin_rad: float,
    ready_m: FloatArray,
    shares: FloatArray,
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at shares (N,) of the path from upright to tilted ready to pour."""
    left = 1 - shares
    cup = target.pouring.cup
    positions = ready_m + left[:, None] * (upright_m - ready_m)
    return tilted_grasps(cup, target.theta_rad, upright_rad(cup) * left, psi_rad + spin_rad * left, positions)


def pouring_grasps(
    target: PourTarget, grip_height_m: float, psi_rad: float, gamma_rad: FloatArray
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) that hold the cup at pour angles (N,), with the pivot in its place."""
    cups = rotated_cups(target.pouring.cup, target.pivot_m, target.theta_rad, gamma_rad)
    positions = cups[:, :3, 3] + grip_height_m * cups[:, :3, 2]
    psi = np.full(len(gamma_rad), psi_rad)
    return tilted_grasps(target.pouring.cup, target.theta_rad, gamma_rad, psi, positions)


def imagined_rate(pouring: PouringParameters, gamma_rad: FloatArray) -> FloatArray:
    """Rates (N,) of the imagined rotation at pour angles (N,), in rad/s; zero at its end."""
    _, at_first = pour_angle(pouring, pouring.settle_s + 1e-12)
    share = np.clip(gamma_rad / pouring.gamma_0_rad, 0, 1)
    return np.asarray(at_first * np.sqrt(1 - share**2))
