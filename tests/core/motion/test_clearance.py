import numpy as np
import pytest

from core.geometry import make_pose, rotation_z, transform_points
from core.motion.arm_models import UR5, arm_shape, capsule_around_box
from core.motion.clearance import MotionScene, Obstacle, axis_aligned_obstacle
from core.motion.distances import segment_segment_distance
from core.motion.kinematics import link_poses

UPRIGHT_RAD = np.radians([0.0, -90, 0, -90, 0, 0])


def along(start: np.ndarray, end: np.ndarray, n: int) -> np.ndarray:
    return start[..., None, :] + np.linspace(0, 1, n)[:, None] * (end - start)[..., None, :]


def test_clearance_is_that_of_the_nearest_capsule_to_an_oriented_box():
    box = Obstacle("crate", make_pose(rotation_z(0.4), (0.5, -0.4, 0.3)), (0.3, 0.2, 0.4))
    shape = arm_shape(UR5)
    joints = np.random.default_rng(2).uniform(-3, 3, (40, 6))
    result = MotionScene(UR5, shape, [box]).clearance(joints)
    alone = MotionScene(UR5, shape, []).clearance(joints)
    poses = link_poses(UR5, joints)
    for k in range(len(joints)):
        nearest = alone.distance_m[k]
        for capsule in shape.capsules:
            ends = transform_points(poses[k, capsule.link], [capsule.start_m, capsule.end_m])
            points = transform_points(np.linalg.inv(box.T_base_box), along(ends[0], ends[1], 1001))
            half = np.array(box.size_m) / 2
            to_box = np.linalg.norm(points - np.clip(points, -half, half), axis=1).min() - capsule.radius_m
            nearest = min(nearest, to_box)
        assert result.distance_m[k] == pytest.approx(nearest, abs=5e-4)


def test_nearest_pair_is_named():
    wall = axis_aligned_obstacle("wall", (-0.1, -0.1, 1.0), (0.1, 0.1, 1.1))
    result = MotionScene(UR5, arm_shape(UR5), [wall]).clearance(UPRIGHT_RAD[None])
    assert result.nearest(0)[1] == "wall"
    assert result.distance_m[0] < 0


def test_exempt_parts_may_touch():
    floor = ((-1.0, -1.0, -0.1), (1.0, 1.0, 0.0))
    named = frozenset({"base"})
    touching = MotionScene(UR5, arm_shape(UR5), [axis_aligned_obstacle("floor", *floor)])
    exempt = MotionScene(UR5, arm_shape(UR5), [axis_aligned_obstacle("floor", *floor, named)])
    assert touching.clearance(UPRIGHT_RAD[None]).distance_m[0] < 0
    assert "base" not in exempt.clearance(UPRIGHT_RAD[None]).nearest(0)


def test_folded_arm_touches_itself_and_the_upright_one_does_not():
    folded = np.radians([0.0, -90, 165, 0, 90, 0])
    result = MotionScene(UR5, arm_shape(UR5), []).clearance(np.array([folded, UPRIGHT_RAD]))
    assert result.distance_m[0] < 0
    assert result.distance_m[1] > 0.02


def test_capsule_takes_in_the_whole_box():
    size = (0.18, 0.036, 0.025)
    pose = make_pose(rotation_z(0.3), (0.05, 0.02, 0.04))
    capsule = capsule_around_box("camera", pose, size)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(size) / 2
    start, end = np.array(capsule.start_m), np.array(capsule.end_m)
    far = segment_segment_distance(
        transform_points(pose, corners), transform_points(pose, corners), start[None], end[None]
    )
    assert far.max() <= capsule.radius_m + 1e-12
