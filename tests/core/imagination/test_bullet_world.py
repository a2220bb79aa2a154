from math import cos, radians, sin

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.geometry import rotation_y
from core.imagination.body import body_files
from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.stand_in import ball_of
from core.mesh import TriangleMesh
from core.parameters import Parameters
from hardware.simulation.objects import boxed
from tests.core.imagination.falling import thrown

TILTS_RAD = (0.0, radians(30))


@pytest.mark.parametrize("speed_m_s", [0.5, 1.2, 2.0, 3.0])
def test_no_candy_slips_through_a_wall_however_fast(speed_m_s):
    parameters = Parameters()
    for tilt_rad in TILTS_RAD:
        settings = parameters.solver, parameters.particle, parameters.pouring.contact
        assert thrown(BulletWorld, *settings, speed_m_s, tilt_rad, seed=0) == (64, 0)


@pytest.mark.parametrize("speed_m_s", [0.5, 1.2, 2.0, 3.0])
def test_no_ball_that_stands_for_several_candies_slips_through(speed_m_s):
    ball = ball_of(Parameters(), 2.0)
    for tilt_rad in TILTS_RAD:
        settings = ball.solver, ball.particle, ball.contact
        assert thrown(BulletWorld, *settings, speed_m_s, tilt_rad, seed=0) == (64, 0)


def test_a_candy_too_fast_for_the_finest_step_is_stopped_on_its_way():
    parameters = Parameters()
    coarse = parameters.solver.model_copy(update={"rate_hz": 60, "substeps": 2})
    for tilt_rad in TILTS_RAD:
        settings = coarse, parameters.particle, parameters.pouring.contact
        assert thrown(BulletWorld, *settings, 2.0, tilt_rad, seed=0) == (64, 0)


def test_candies_slip_through_where_no_step_may_be_refined():
    """The experiment of the tests above sees what it looks for."""
    parameters = Parameters()
    coarse = parameters.solver.model_copy(update={"substeps": 1})
    settings = coarse, parameters.particle, parameters.pouring.contact
    _, slipped = thrown(BulletWorld, *settings, speed_m_s=2.0, tilt_rad=0.0, seed=0)
    assert slipped > 10


SLAB = boxed([(0.8, 0.4, -0.02), (0.8, 0.4, 0.0)], 0.005)
SLOPE_RAD = radians(30)


def followed(contact, starts_m, duration_s, slope_rad=0.0):
    """Centres (K, N, 3) of cylinders let go on a slab; on a slope their frame is turned with it."""
    parameters = Parameters()
    particle = parameters.particle.model_copy(update={"shape": "cylinder"})
    turn = rotation_y(slope_rad)
    slab = TriangleMesh(SLAB.vertices_m @ turn.T, SLAB.faces)
    region_m = np.array([[-0.5, -0.3, -0.5], [0.5, 0.3, 0.5]])
    with (
        body_files(slab=((slab,), True)) as files,
        BulletWorld(parameters.solver, particle, contact, region_m) as world,
    ):
        world.add_fixed_body(files["slab"])
        quaternion = Rotation.from_matrix(turn).as_quat()
        for start in starts_m:
            world.add_particle(np.concatenate([turn @ start, quaternion]))
        centres = []
        for _ in range(round(duration_s * parameters.solver.rate_hz)):
            world.step()
            centres.append(world.poses()[:, :3] @ turn)
    return np.array(centres)


def contact_of(**values):
    return Parameters().pouring.contact.model_copy(
        update={"rolling_friction": 0.0, "spinning_friction": 0.0} | values
    )


@pytest.mark.parametrize("restitution", [0.1, 0.25, 0.5])
def test_a_candy_bounces_as_the_pair_with_the_object_should(restitution):
    half_m = Parameters().particle.height_m / 2
    drops_m = np.linspace(0.09, 0.11, 6)
    starts = np.column_stack([0.05 * np.arange(-3, 3) + 0.01, np.full(6, 0.02), half_m + drops_m])
    heights_m = followed(contact_of(restitution=restitution), starts, 0.6)[:, :, 2] - half_m
    landed = np.argmax(heights_m < 0.003, axis=0)
    highest_m = np.array([heights_m[first:, candy].max() for candy, first in enumerate(landed)])
    kept = np.sqrt(np.maximum(highest_m, 0) / drops_m).mean()
    assert kept == pytest.approx(restitution, abs=0.07)


@pytest.mark.parametrize("candy_friction", [0.02, 0.5])
def test_a_candy_slides_as_its_friction_with_the_object_says_whatever_that_between_candies(candy_friction):
    contact = contact_of(lateral_friction=0.3, candy_friction=candy_friction, restitution=0.0)
    start = np.array([[-0.3, 0.0, Parameters().particle.height_m / 2]])
    slid_m = followed(contact, start, 0.4, SLOPE_RAD)[-1, 0, 0] + 0.3
    acceleration = 9.81 * (sin(SLOPE_RAD) - 0.3 * cos(SLOPE_RAD))
    assert slid_m == pytest.approx(acceleration * 0.4**2 / 2, rel=0.1)


@pytest.mark.parametrize(("candy_friction", "slides"), [(0.02, True), (0.9, False)])
def test_a_candy_slides_on_another_as_the_friction_between_candies_says(candy_friction, slides):
    """The lower one sticks to the object, the upper one lies on it."""
    contact = contact_of(lateral_friction=3.0, candy_friction=candy_friction, restitution=0.0)
    height_m = Parameters().particle.height_m
    starts = np.array([[-0.1, 0.0, height_m / 2], [-0.1, 0.0, 1.5 * height_m]])
    lower, upper = followed(contact, starts, 0.2, radians(20))[-1]
    assert abs(lower[0] + 0.1) < 0.002
    assert (upper[0] - lower[0] > 0.004) == slides
