from dataclasses import replace

import numpy as np
import pytest

from core.imagination.amount.reasoning import LIFTED, REPOSE, safe_candies, sure_candies
from core.parameters import apply_settings
from tests.core.imagination.amount.conftest import capacity_of, cone, cylinder


def exact(parameters):
    """Without an error of the candies' size."""
    return apply_settings(parameters, {"risk.candy_spread": 0.0})


def test_spread_and_larger_candies_are_taken_off(planned):
    capacity = cylinder(200, spread=10.0)
    assert sure_candies(capacity, exact(planned)) == pytest.approx(180)
    assert sure_candies(capacity, planned) == pytest.approx(180 / 1.05**3)
    assert sure_candies(cylinder(200, spread=150.0), planned) == 0.0


def test_a_cylinder_stays_below_its_rim_by_heap_and_candy(planned):
    freeboard_m = LIFTED * REPOSE * 0.03 + 0.0132
    expected = int(1000 * (0.1 - freeboard_m) / 0.1)
    assert safe_candies(cylinder(1000, 0.03, 0.1), exact(planned)) == expected
    assert safe_candies(cylinder(1000, 0.03, 0.2), exact(planned)) > expected
    assert safe_candies(cylinder(1000, 0.06, 0.1), exact(planned)) < expected


def test_larger_candies_leave_more_room(planned):
    larger = apply_settings(exact(planned), {"particle.diameter_m": 0.02})
    assert safe_candies(cylinder(1000), larger) < safe_candies(cylinder(1000), exact(planned))


def test_a_cone_loses_more_for_it_is_widest_at_its_rim(planned):
    # The upper tenth of the cone is as wide as a circle of 0.0475 m.
    freeboard_m = LIFTED * REPOSE * 0.05 * np.sqrt((1 - 0.9**3) / 0.3) + 0.0132
    expected = 1000 * ((0.1 - freeboard_m) / 0.1) ** 3
    assert safe_candies(cone(1000), exact(planned)) == pytest.approx(expected, abs=2)
    assert safe_candies(cone(1000), exact(planned)) < safe_candies(cylinder(1000, 0.0475), exact(planned))


def test_a_shallow_object_and_one_without_a_closed_rim_take_half_of_what_is_sure(planned):
    shallow = cylinder(400, 0.12, 0.02, spread=10.0)
    assert safe_candies(shallow, exact(planned)) == 190
    assert safe_candies(capacity_of(160.0), exact(planned)) == 80


def test_the_foot_of_a_heap_off_the_middle_is_lifted_as_said():
    points = np.random.default_rng(0).uniform(-1, 1, (400_000, 2))
    disc = points[np.hypot(*points.T) < 1]
    below_apex = np.hypot(disc[:, 0] - 0.5, disc[:, 1])
    assert below_apex.mean() - 0.5 == pytest.approx(LIFTED, abs=0.005)


def test_candies_heaped_above_the_rim_do_not_count(planned):
    level = cylinder(400)
    heaped = replace(level, n_candies=500.0, heaped_ml=100 / level.candies_per_ml)
    assert safe_candies(heaped, exact(planned)) == safe_candies(level, exact(planned))
