"""How far beside its path an arm is: by the points that really move, at the nearest moment of the path."""

from __future__ import annotations

import numpy as np
import pytest

from core.motion.kinematics import flange_pose
from core.motion.margin import SHARE_OF_CLEARANCE, path_margin
from hardware.cell import read_cell
from hardware.cell.scene import motion_scene

SCENE = motion_scene(read_cell())
HOME = np.array(read_cell().robot.home_rad)
WAY = HOME + np.linspace(0, 1, 200)[:, None] * np.array([0.6, 0.2, -0.3, 0.1, 0.2, 0.5])


@pytest.fixture(scope="module")
def margin():
    return path_margin(SCENE, WAY, 0.008, np.array([[0.0, -0.15, 0.15]]))


def test_it_is_a_share_of_the_clearance(margin):
    assert margin.allowed_m == SHARE_OF_CLEARANCE * 0.008


def test_an_arm_on_its_path_is_not_beside_it_whatever_the_moment(margin):
    for share in np.random.default_rng(1).uniform(0, 199, 50):
        k = int(share)
        between = WAY[k] + (share - k) * (WAY[k + 1] - WAY[k])
        assert margin.beside_m(between, WAY) <= margin.allowed_m


def test_a_jump_is_never_taken_for_less_than_the_hand_moves(margin):
    chance = np.random.default_rng(2)
    for _ in range(50):
        offset = chance.uniform(-0.05, 0.05, 6)
        joints = WAY[100] + offset
        beside_m = margin.beside_m(joints, WAY)
        held = (flange_pose(SCENE.arm, np.array([joints, *WAY])) @ [0.0, -0.15, 0.15, 1.0])[:, :3]
        nearest_m = np.linalg.norm(held[1:] - held[0], axis=1).min()
        assert beside_m >= nearest_m - 3e-4
        assert beside_m <= np.abs(offset) @ margin.levers_m + 1e-9


def test_a_lever_is_as_long_as_the_arm_reaches_from_the_joint(margin):
    assert margin.levers_m[0] > 0.4
    assert (np.diff(margin.levers_m[2:]) < 0.05).all()
    assert (margin.levers_m > 0.05).all()
