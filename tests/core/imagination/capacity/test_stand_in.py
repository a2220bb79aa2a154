from math import pi

import pytest

from core.imagination.capacity.filling import overflows
from core.imagination.capacity.stand_in import (
    NOWHERE,
    Surroundings,
    ball_of,
    bulk_ml,
    candy_itself,
    packing_fraction,
    particle_volume_m3,
    stand_in_for,
)


def test_a_ball_has_the_volume_and_mass_of_the_candies_it_stands_for(candies):
    ball = ball_of(candies, 2.0)
    assert particle_volume_m3(ball.particle) == pytest.approx(8 * pi / 6 * 0.0132**2 * 0.007)
    assert ball.particle.mass_kg == pytest.approx(8 * 0.0009)
    assert ball.contact.lateral_friction == 0.2
    assert ball.contact.rolling_friction == pytest.approx(0.04)
    assert ball.solver.rate_hz == 170


def test_bulk_is_less_dense_near_walls(candies):
    candy, ball = candies.particle, ball_of(candies, 2.0).particle
    narrow = Surroundings(volume_m3=1e-4, floor_m2=2e-3, side_m2=8e-3)
    for particle in (candy, ball):
        assert 0.5 < packing_fraction(particle, narrow) < packing_fraction(particle, NOWHERE) < 0.65
    assert bulk_ml(candy, narrow) == pytest.approx(0.6386 / packing_fraction(candy, narrow), rel=1e-3)


def test_candies_stand_for_themselves(candies):
    assert candy_itself(candies).scale == 1
    assert candy_itself(candies).particle == candies.particle


def test_balls_stand_for_candies_where_these_are_too_many(candies):
    settings = candies.capacity
    assert stand_in_for(settings.n_real, 0.08, candies) == candy_itself(candies)
    many = 8 * max(settings.n_aimed, settings.n_real)
    wide, narrow = (stand_in_for(many, mouth_m, candies) for mouth_m in (1.0, 0.02))
    assert wide.scale == pytest.approx((many / settings.n_aimed) ** (1 / 3))
    assert 1 < narrow.scale < wide.scale, "a mouth has to let them pass"


def test_it_overflows_when_the_last_candies_do_not_add_up():
    assert not overflows([(10, 10)], 8)
    assert not overflows([(10, 10), (20, 15)], 8)
    assert overflows([(10, 10), (20, 13)], 8)
    # Too few since then to tell.
    assert not overflows([(10, 10), (14, 10)], 8)
