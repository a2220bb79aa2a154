"""Our closed form against `ur_analytic_ik`, written by others, after other papers, in another language."""

import numpy as np
import pytest

from core.motion.arm_models import UR5, UR5E, ArmModel
from core.motion.kinematics import flange_pose, inverse_kinematics

oracle = pytest.importorskip("ur_analytic_ik", reason="needs the package ur-analytic-ik")

ORACLES = {UR5.name: oracle.ur5, UR5E.name: oracle.ur5e}
N_POSES = 10_000
ARMS = pytest.mark.parametrize("arm", [UR5, UR5E], ids=lambda arm: arm.name)


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """How far (A, B) configurations (A, 6) and (B, 6) are from each other, whole turns apart."""
    difference = a[:, None] - b[None]
    return np.abs(difference - 2 * np.pi * np.round(difference / (2 * np.pi))).max(axis=-1)


@ARMS
def test_forward_kinematics_agree(arm: ArmModel):
    joints = np.random.default_rng(1).uniform(-2 * np.pi, 2 * np.pi, (1000, 6))
    theirs = np.array([ORACLES[arm.name].forward_kinematics(*row) for row in joints])
    assert flange_pose(arm, joints) == pytest.approx(theirs, abs=1e-12)


@ARMS
def test_no_branch_is_wrong_and_none_is_missed(arm: ArmModel):
    joints = np.random.default_rng(0).uniform(-np.pi, np.pi, (N_POSES, 6))
    poses = flange_pose(arm, joints)
    ours = inverse_kinematics(arm, poses)
    reached = flange_pose(arm, ours.joints_rad[ours.found])
    wanted = poses[np.nonzero(ours.found)[0]]
    assert np.linalg.norm(reached[:, :3, 3] - wanted[:, :3, 3], axis=1).max() < 1e-6
    turned = np.swapaxes(reached[:, :3, :3], 1, 2) @ wanted[:, :3, :3]
    # the angle of a small turn is the norm of its skew part, in which rounding does not grow
    skew = turned - np.swapaxes(turned, 1, 2)
    assert np.linalg.norm(skew[:, [2, 0, 1], [1, 2, 0]], axis=1).max() / 2 < 1e-6
    for pose, rows, found in zip(poses, ours.joints_rad, ours.found, strict=True):
        theirs = np.array(ORACLES[arm.name].inverse_kinematics(np.ascontiguousarray(pose)))
        between = apart(rows[found], theirs)
        assert between.min(axis=1).max() < 1e-6
        assert between.min(axis=0).max() < 1e-6
        assert len(theirs) == found.sum()


@ARMS
def test_out_of_reach_for_both(arm: ArmModel):
    random = np.random.default_rng(2)
    poses = flange_pose(arm, random.uniform(-np.pi, np.pi, (500, 6)))
    poses[:, :3, 3] *= random.uniform(1.0, 2.0, (500, 1))
    ours = inverse_kinematics(arm, poses).found.sum(axis=1)
    theirs = [len(ORACLES[arm.name].inverse_kinematics(np.ascontiguousarray(pose))) for pose in poses]
    assert 0 in theirs
    assert ours.tolist() == theirs
