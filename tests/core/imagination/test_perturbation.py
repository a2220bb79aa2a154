from math import pi

import numpy as np
import pytest

from core.geometry import transform_points
from core.imagination.perturbation import Perturbation
from core.imagination.rotations import quaternion_of
from core.parameters import load_preset

CENTER = np.array([0.1, -0.2, 0.3])


@pytest.fixture
def perturbation():
    return Perturbation(load_preset("paper").containability, CENTER)


def angle_rad(motion, axis):
    """Angle of the rotation about x (0) or y (1)."""
    rotation = motion.T_world_object[:3, :3]
    return np.arctan2(rotation[2, 1], rotation[2, 2]) if axis == 0 else np.arcsin(rotation[0, 2])


def test_the_schedule_of_fig_3a(perturbation):
    step = 1 / 240
    at_rest = perturbation.at(149 * step)
    assert (at_rest.T_world_object == np.eye(4)).all()
    assert angle_rad(perturbation.at(300 * step), 0) == pytest.approx(pi / 60)
    assert angle_rad(perturbation.at(600 * step), 0) == pytest.approx(-pi / 60)
    assert angle_rad(perturbation.at(900 * step), 1) == pytest.approx(pi / 60)
    assert angle_rad(perturbation.at(1200 * step), 1) == pytest.approx(-pi / 60)
    pushes = [perturbation.at(moment * step).gravity_m_s2[:2].tolist() for moment in (1351, 1390, 1430, 1470)]
    assert pushes == [[0.5, 0], [-0.5, 0], [0, 0.5], [0, -0.5]]
    assert round(perturbation.duration_s * 240) == 1500


def test_the_centre_of_mass_stays(perturbation):
    for time_s in np.linspace(0, perturbation.duration_s, 50):
        moved = transform_points(perturbation.at(time_s).T_world_object, CENTER)
        assert moved == pytest.approx(CENTER)


def test_the_rate_is_the_derivative_of_the_angle(perturbation):
    dt = 1e-6
    for time_s, axis in ((1.0, 0), (2.2, 0), (3.5, 1), (4.9, 1)):
        change = angle_rad(perturbation.at(time_s + dt), axis) - angle_rad(perturbation.at(time_s), axis)
        assert perturbation.at(time_s).angular_velocity_rad_s[axis] == pytest.approx(
            change / dt, rel=1e-3, abs=1e-6
        )


def test_quaternions_agree_with_scipy():
    from scipy.spatial.transform import Rotation

    for rotation in Rotation.random(200, random_state=1):
        ours, theirs = quaternion_of(rotation.as_matrix()), rotation.as_quat()
        assert abs(ours @ theirs) == pytest.approx(1, abs=1e-12)


def test_no_point_of_the_object_leaves_its_reach():
    settings = load_preset("paper").containability.model_copy(update={"rotation_rad": 0.3})
    perturbation = Perturbation(settings, CENTER)
    aabb_m = CENTER + np.array([[-0.2, -0.1, -0.05], [0.25, 0.1, 0.1]])
    corners = np.array([[x, y, z] for x in aabb_m[:, 0] for y in aabb_m[:, 1] for z in aabb_m[:, 2]])
    low, high = perturbation.reach_m(aabb_m)
    for time_s in np.linspace(0, perturbation.duration_s, 200):
        moved = transform_points(perturbation.at(time_s).T_world_object, corners)
        assert (moved >= low).all() and (moved <= high).all()
    lowest = min(
        transform_points(perturbation.at(t).T_world_object, corners)[:, 2].min()
        for t in np.linspace(0, perturbation.duration_s, 200)
    )
    assert lowest < aabb_m[0, 2] - 0.04, "turned like this, its corners go well below where it stood"
