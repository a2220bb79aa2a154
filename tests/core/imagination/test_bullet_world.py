from math import radians

import pytest

from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.stand_in import ball_of
from core.parameters import Parameters
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


def test_candies_slip_through_where_no_step_may_be_refined():
    """The experiment of the tests above sees what it looks for."""
    parameters = Parameters()
    coarse = parameters.solver.model_copy(update={"substeps": 1})
    settings = coarse, parameters.particle, parameters.pouring.contact
    _, slipped = thrown(BulletWorld, *settings, speed_m_s=2.0, tilt_rad=0.0, seed=0)
    assert slipped > 10
