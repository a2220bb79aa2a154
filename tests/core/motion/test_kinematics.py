import numpy as np
import pytest

from core.motion.arm_models import UR5, UR5E, ArmModel
from core.motion.kinematics import (
    branch_of,
    configurations,
    flange_pose,
    inverse_kinematics,
    jacobian,
    nearest_turn,
    singularity_measure,
    within_limits,
)

TURN = 2 * np.pi
ARMS = pytest.mark.parametrize("arm", [UR5, UR5E], ids=lambda arm: arm.name)


def random_joints(n: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-TURN, TURN, (n, 6))


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    difference = a - b
    return np.abs(difference - TURN * np.round(difference / TURN)).max(axis=-1)


def test_zero_pose_is_the_stretched_arm_along_minus_x():
    T = flange_pose(UR5, np.zeros(6))
    assert T[:3, 3] == pytest.approx([-0.81725, -0.10915 - 0.0823, 0.089159 - 0.09465])
    assert T[:3, 2] == pytest.approx([0, -1, 0])


def test_recorded_poses_agree_with_the_published_parameters(shared_data):
    joints = np.loadtxt(shared_data / "cell" / "scan_views.csv", delimiter=",", skiprows=1)
    T_flange_camera = np.loadtxt(shared_data / "cell" / "camera_in_flange.txt").reshape(4, 4)
    files = sorted((shared_data / "real_scan" / "amazon_tray" / "rgbd").glob("*.pose.txt"))
    recorded = np.array([np.loadtxt(file) for file in files])
    ours = flange_pose(UR5, joints) @ T_flange_camera
    traces = np.einsum("nij,nij->n", ours[:, :3, :3], recorded[:, :3, :3])
    assert len(files) == 24
    assert np.degrees(np.arccos((traces - 1) / 2)).max() < 1.6
    assert np.linalg.norm(ours[:, :3, 3] - recorded[:, :3, 3], axis=1).max() < 0.004


@ARMS
def test_inverse_contains_the_original_and_every_branch_reaches_the_pose(arm: ArmModel):
    joints = random_joints(10_000)
    poses = flange_pose(arm, joints)
    branches = inverse_kinematics(arm, poses)
    original = np.where(branches.found, apart(branches.joints_rad, joints[:, None]), np.inf).min(axis=1)
    assert original.max() < 1e-6
    error = np.abs(flange_pose(arm, branches.joints_rad) - poses[:, None]).max(axis=(-1, -2))
    assert error[branches.found].max() < 1e-6
    assert branches.found.sum(axis=1).max() == 8


@ARMS
def test_branch_of_a_configuration_is_the_one_that_finds_it(arm: ArmModel):
    joints = random_joints(2000)
    branches = branch_of(arm, joints)
    found = inverse_kinematics(arm, flange_pose(arm, joints))
    assert apart(found.joints_rad[np.arange(len(joints)), branches], joints).max() < 1e-6
    for branch in range(8):
        alone = inverse_kinematics(arm, flange_pose(arm, joints[:50]), (branch,))
        assert np.array_equal(alone.joints_rad[:, 0], found.joints_rad[:50, branch])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "degrees",
    [(0, -90, 0, -90, 0, 0), (0, 0, 0, 0, 0, 0), (30, -60, 70, -20, 0, 40), (10, -80, 90, 20, 180, 5)],
)
def test_wrist_singular_poses_say_so_and_give_one_configuration_of_many(degrees):
    pose = flange_pose(UR5, np.radians(degrees))
    branches = inverse_kinematics(UR5, pose[None])
    assert branches.undetermined.any()
    assert np.isfinite(branches.joints_rad).all()
    found = configurations(UR5, pose)
    assert len(found) > 0
    assert flange_pose(UR5, found) == pytest.approx(np.tile(pose, (len(found), 1, 1)), abs=1e-6)
    assert singularity_measure(UR5, np.radians(degrees)) < 1e-6


@pytest.mark.filterwarnings("error")
def test_stretched_elbow_merges_two_branches():
    pose = flange_pose(UR5, np.radians([20, -50, 0, 30, 80, 10]))
    assert len(configurations(UR5, pose)) < 8
    assert apart(configurations(UR5, pose), np.radians([20, -50, 0, 30, 80, 10])).min() < 1e-6


@pytest.mark.filterwarnings("error")
def test_out_of_reach_has_no_branch():
    pose = np.eye(4)
    pose[:3, 3] = 1.2, 0, 0.2
    assert configurations(UR5, pose).shape == (0, 6)
    inside_the_base = np.eye(4)
    inside_the_base[2, 3] = 0.5
    assert configurations(UR5, inside_the_base).shape == (0, 6)


def test_jacobian_is_the_derivative_of_the_flange_pose():
    joints = random_joints(50)
    J = jacobian(UR5, joints)
    h = 1e-6
    for k in range(6):
        ahead, behind = (flange_pose(UR5, joints + sign * h * np.eye(6)[k]) for sign in (1, -1))
        speed = (ahead - behind) / (2 * h)
        turning = speed[:, :3, :3] @ np.swapaxes(flange_pose(UR5, joints)[:, :3, :3], 1, 2)
        assert J[:, :3, k] == pytest.approx(speed[:, :3, 3], abs=1e-8)
        vector = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
        assert J[:, 3:, k] == pytest.approx(vector, abs=1e-8)


def test_nearest_turn_is_the_nearest_one_within_the_limits():
    joints, reference = random_joints(2000) / 2, random_joints(2000, seed=1)
    turned = nearest_turn(UR5, joints, reference)
    assert within_limits(UR5, turned).all()
    for turns in (-2, -1, 0, 1, 2):
        other = joints + TURN * turns
        inside = within_limits(UR5, other)
        assert (np.abs(turned - reference) <= np.abs(other - reference) + 1e-9)[inside].all()
    assert apart(turned, joints).max() < 1e-9
