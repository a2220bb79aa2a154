from dataclasses import replace

import numpy as np
import pytest

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.arm_models import UR5, UR5E, ArmModel
from core.motion.factory_calibration import MeasuredKinematics, calibrated
from core.motion.kinematics import (
    branch_of,
    flange_pose,
    inverse_kinematics,
    jacobian,
    joint_poses,
    link_poses,
    singularity_measure,
)
from tests.core.motion.measured_arms import CHECKSUM, measured_arm

ARMS = pytest.mark.parametrize("arm", [UR5, UR5E], ids=lambda arm: arm.name)
JOINTS = np.random.default_rng(1).uniform(-np.pi, np.pi, (2000, 6))


def published(arm: ArmModel) -> MeasuredKinematics:
    return MeasuredKinematics((0.0,) * 6, arm.a_m, arm.d_m, arm.alpha_rad, CHECKSUM)


def by_the_parameters(measured: MeasuredKinematics, joints_rad: FloatArray) -> FloatArray:
    """The flange, straight from the parameters."""
    steps = joint_poses(
        measured.a_m, measured.d_m, measured.alpha_rad, joints_rad + np.array(measured.theta_rad)
    )
    pose = np.eye(4)
    for k in range(6):
        pose = pose @ steps[:, k]
    return pose


@ARMS
@pytest.mark.parametrize("seed", range(5))
def test_the_flange_is_where_the_measured_parameters_put_it(arm: ArmModel, seed: int) -> None:
    measured = measured_arm(arm, seed)
    own = calibrated(arm, measured)
    np.testing.assert_allclose(flange_pose(own, JOINTS), by_the_parameters(measured, JOINTS), atol=1e-9)
    apart_m = np.linalg.norm((flange_pose(own, JOINTS) - flange_pose(arm, JOINTS))[:, :3, 3], axis=1)
    assert 0.001 < np.median(apart_m) < 0.02


@ARMS
@pytest.mark.parametrize("seed", range(5))
def test_every_link_stays_near_the_published_one(arm: ArmModel, seed: int) -> None:
    """So that the arm's shape, which is fixed to the links, stays where it is to millimetres."""
    measured = measured_arm(arm, seed)
    assert np.abs(measured.d_m).max() > 1, "nearly parallel axes meet far away"
    apart_m = link_poses(calibrated(arm, measured), JOINTS)[..., :3, 3] - link_poses(arm, JOINTS)[..., :3, 3]
    assert np.linalg.norm(apart_m, axis=-1).max() < 0.02


@ARMS
@pytest.mark.parametrize("seed", range(5))
def test_the_inverse_reaches_every_pose_by_the_own_kinematics(arm: ArmModel, seed: int) -> None:
    own = calibrated(arm, measured_arm(arm, seed))
    joints = JOINTS[singularity_measure(arm, JOINTS) > 0.02]
    poses = flange_pose(own, joints)
    found = inverse_kinematics(own, poses)
    reached = flange_pose(own, found.joints_rad)
    error = np.abs(reached - poses[:, None]).max(axis=(-1, -2))
    assert error[found.found].max() < 1e-6
    assert np.quantile(error[found.found], 0.99) < 1e-12
    back = found.joints_rad[np.arange(len(joints)), branch_of(own, joints)]
    apart = np.abs((back - joints + np.pi) % (2 * np.pi) - np.pi).max(axis=1)
    assert (apart < 1e-5).mean() > 0.99, "at the edge of its reach the published arm may fall short"


@pytest.mark.filterwarnings("error")
def test_a_singular_pose_has_no_wrong_branch() -> None:
    own = calibrated(UR5, measured_arm(UR5, 0))
    poses = flange_pose(
        own, np.radians([[0, -90, 0, -90, 0, 0], [20, -50, 0, 30, 80, 10], [30, -60, 70, -20, 0, 40]])
    )
    found = inverse_kinematics(own, poses)
    assert np.isfinite(found.joints_rad).all()
    error = np.abs(flange_pose(own, found.joints_rad) - poses[:, None]).max(axis=(-1, -2))
    assert (error[found.found] < 1e-6).all()


def test_the_jacobian_is_the_own_kinematics_derivative() -> None:
    own, joints, h = calibrated(UR5, measured_arm(UR5, 3)), JOINTS[:20], 1e-6
    for k in range(6):
        ahead, behind = (flange_pose(own, joints + sign * h * np.eye(6)[k]) for sign in (1, -1))
        speed_m = (ahead - behind)[:, :3, 3] / (2 * h)
        np.testing.assert_allclose(jacobian(own, joints)[:, :3, k], speed_m, atol=1e-7)


@ARMS
def test_published_parameters_change_nothing(arm: ArmModel) -> None:
    assert calibrated(arm, published(arm)) is arm
    nine_decimals = tuple(round(alpha, 9) for alpha in arm.alpha_rad)
    assert calibrated(arm, replace(published(arm), alpha_rad=nine_decimals)) is arm


def test_a_longer_forearm_is_that() -> None:
    longer = (0.0, -0.425, -0.39225 - 0.0045, 0.0, 0.0, 0.0)
    own = calibrated(UR5, replace(published(UR5), a_m=longer))
    np.testing.assert_allclose(
        flange_pose(own, JOINTS), flange_pose(replace(UR5, a_m=longer), JOINTS), atol=1e-12
    )


@pytest.mark.parametrize(
    "measured",
    [
        published(UR5E),
        replace(published(UR5), a_m=(0.0, -0.425, -0.45, 0.0, 0.0, 0.0)),
        replace(published(UR5), alpha_rad=(0.0,) * 6),
        replace(published(UR5), theta_rad=(0.2, 0.0, 0.0, 0.0, 0.0, 0.2)),
        replace(published(UR5), d_m=(float("nan"),) * 6),
        replace(published(UR5), d_m=(1e300,) * 6),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_no_arm_of_the_model_has_is_refused(measured: MeasuredKinematics) -> None:
    with pytest.raises(MotionError, match="from those of a UR5"):
        calibrated(UR5, measured)
