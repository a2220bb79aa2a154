"""Where hand and cup are in each part of a pour: poses of the tool frame along a way (Sec. III-B, Eq. 6).

The cup is round, so it may sit in the hand at any angle psi about its axis: psi tells where on its rim, seen
from the hand, the pivot is. While the cup is upright, one azimuth tells how the hand stands: that of the tool
frame's x-axis in the base frame.
"""

from __future__ import annotations

from math import pi

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_z
from core.imagination.cup import cup_pose, inner_radius_m, pivot_in_cup_m
from core.motion.cone import Cone
from core.parameters.imagination import CupParameters


def outer_cone(cup: CupParameters) -> Cone:
    """The cup's outside, closed, in the cup's frame; as the imagination has it."""
    return Cone(float(inner_radius_m(cup, 0.0)) + cup.wall_m, cup.mouth_radius_m, cup.length_m)


def grasp_of_cup(psi_rad: float, grip_height_m: float) -> FloatArray:
    """`T_grasp_cup` (4, 4): gripped at a height above its base, the pivot at the angle psi."""
    return make_pose(rotation_z(psi_rad), (0.0, 0.0, -grip_height_m))


def hand_angle_rad(T_flange_grasp: FloatArray) -> float:
    """The angle about the cup's axis, in the tool frame, towards which the hand points.

    With the pivot there, the hand is opposite to it: above the cup that lies ready to pour.
    """
    flange_z = T_flange_grasp[2, :3]
    return float(np.arctan2(flange_z[1], flange_z[0]))


def upright_rad(cup: CupParameters) -> float:
    """The pour angle gamma, below zero, at which the cup stands upright."""
    return cup.slant_rad - pi / 2


def upright_azimuth_rad(theta_rad: float, psi_rad: float) -> float:
    """The hand's azimuth when the cup of a pour has been turned upright about the pour's axis."""
    return theta_rad + pi - psi_rad


def upright_grasps(positions_m: FloatArray, azimuths_rad: FloatArray) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) with the cup upright, at positions (N, 3) and azimuths (N,)."""
    poses = np.tile(np.eye(4), (len(positions_m), 1, 1))
    c, s = np.cos(azimuths_rad), np.sin(azimuths_rad)
    poses[:, 0, 0], poses[:, 0, 1], poses[:, 1, 0], poses[:, 1, 1] = c, -s, s, c
    poses[:, :3, 3] = positions_m
    return poses


def turned_cups(
    cup: CupParameters, pivot_m: FloatArray, theta_rad: float, gamma_rad: FloatArray
) -> FloatArray:
    """`T_base_cup` (N, 4, 4) turned by gamma (N,) about the pour's axis, the pivot where it shall be.

    The same poses as `cup_pose` gives one by one.
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


def laying_grasps(
    cup: CupParameters, theta_rad: float, gamma_rad: FloatArray, psi_rad: FloatArray, positions_m: FloatArray
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at positions (N, 3), the cup tilted as by gamma (N,) in the direction of a
    pour.

    The hand may go round the cup's axis meanwhile, psi (N,): cup and candies do not mind, they lie still.
    """
    poses = turned_cups(cup, np.zeros(3), theta_rad, gamma_rad)
    c, s = np.cos(psi_rad), np.sin(psi_rad)
    back = np.zeros((len(psi_rad), 3, 3))
    back[:, 0, 0], back[:, 0, 1], back[:, 1, 0], back[:, 1, 1], back[:, 2, 2] = c, s, -s, c, 1
    poses[:, :3, :3] = poses[:, :3, :3] @ back
    poses[:, :3, 3] = positions_m
    return poses
