"""Analytic bodies, on which geometry says at which tilt a candy leaves."""

from math import atan, atan2, cos, degrees, radians, sqrt

import numpy as np
import pytest

from core.imagination.body import body_files
from core.imagination.cup import cup_parts
from core.imagination.object_at_rest import ObjectAtRest
from core.imagination.retention import imagine as retention
from core.imagination.retention.imagine import tilt_angles_rad, tilt_task, tilted_gravity_m_s2
from core.parameters import Parameters, apply_settings
from core.parameters.bodies import CupParameters
from core.parameters.imagination import RetentionParameters
from tests.core.imagination.conftest import box

SETTINGS = RetentionParameters(
    n_load=9,
    tilt_step_rad=radians(3),
    tilt_max_rad=radians(90),
    hold_s=0.25,
    rest_m_s=0.05,
)
STEP_DEG, WIDTH_M, WALL_M, RADIUS_M = 3, 0.08, 0.005, 0.01
CANDY = {"particle.shape": "ellipsoid", "particle.diameter_m": 0.0132, "particle.height_m": 0.007}
BALL = {
    "particle.shape": "sphere",
    "particle.diameter_m": 2 * RADIUS_M,
    "containability.contact.lateral_friction": 0.5,
    "containability.contact.rolling_friction": 0.0,
    "containability.contact.spinning_friction": 0.0,
}


def on_floor(height_m):
    """Nine candies at rest, 20 mm from each other, in the middle of a floor at z = 0."""
    grid = WIDTH_M / 2 + 0.02 * np.array([-1, 0, 1])
    return np.array([[x, y, height_m, 0, 0, 0, 1] for x in grid for y in grid])


def n_left(parts, load, settings, direction_rad=0.0, room_m=0.03):
    """Tilt parts with a load; the AABB has room for the candies above the floor."""
    with body_files(object=(parts, False)) as files:
        aabb = np.array([[0.0, 0.0, -0.006], [WIDTH_M, WIDTH_M, room_m]])
        target = ObjectAtRest(files["object"], aabb, aabb.mean(axis=0))
        parameters = apply_settings(Parameters(), settings).model_copy(update={"holding": SETTINGS})
        task = tilt_task(target, load, direction_rad, parameters)
        return task.function(*task.arguments)


def half_gone_deg(left):
    """Tilt of the first step after which half of the load has left."""
    return degrees(tilt_angles_rad(SETTINGS)[np.flatnonzero(left <= left[0] / 2)[0]])


def plate():
    return (box((0, 0, -0.005), (WIDTH_M, WIDTH_M, 0)),)


def walled(height_m):
    """The plate with a wall on the side of x."""
    return (*plate(), box((WIDTH_M - WALL_M, 0, -0.005), (WIDTH_M, WIDTH_M, height_m)))


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.5])
@pytest.mark.parametrize("direction_deg", [0, 135])
def test_a_plate_loses_what_lies_on_it_at_the_angle_of_friction(friction, direction_deg):
    settings = {
        **CANDY,
        "containability.contact.lateral_friction": friction,
        "containability.contact.rolling_friction": 0.02,
    }
    left = n_left(plate(), on_floor(0.0036), settings, radians(direction_deg))
    angle = degrees(atan(friction))
    assert left[0] == 9
    assert left[int(angle / STEP_DEG)] == 9
    # The way to the edge takes a while.
    assert angle < half_gone_deg(left) < angle + 3.5 * STEP_DEG
    assert left[-1] == 0


@pytest.mark.parametrize("height_m", [0.002, 0.004, 0.006])
def test_a_ball_leaves_when_its_weight_points_past_the_walls_edge(height_m):
    """A wall lower than the radius touches a ball with its edge, beside and below the centre."""
    beside_m = sqrt(RADIUS_M**2 - (RADIUS_M - height_m) ** 2)
    angle = degrees(atan2(beside_m, RADIUS_M - height_m))
    # Beside the wall: a ball that comes from afar has the speed to roll over it.
    row = np.tile([WIDTH_M - WALL_M - beside_m - 0.0005, 0, RADIUS_M, 0, 0, 0, 1], (3, 1))
    row[:, 1] = WIDTH_M / 2 + 0.025 * np.array([-1, 0, 1])
    left = n_left(walled(height_m), row, BALL)
    assert left[int((angle - STEP_DEG) / STEP_DEG)] == 3
    assert abs(half_gone_deg(left) - angle) <= 1.5 * STEP_DEG


def test_a_wall_as_high_as_the_centre_holds_a_ball_to_the_end():
    row = on_floor(RADIUS_M)[:1]
    assert n_left(walled(0.015), row, BALL).tolist() == [1] * 31


def test_a_deep_cup_holds_beyond_sixty_degrees():
    cup = CupParameters(length_m=0.1, mouth_radius_m=0.04, slant_rad=0.0, wall_m=0.003)
    middle_m = WIDTH_M / 2
    parts = tuple(part.translated(np.array([middle_m, middle_m, 0.0])) for part in cup_parts(cup))
    left = n_left(parts, on_floor(0.0036 + 0.003), CANDY, room_m=0.1)
    assert left[round(63 / STEP_DEG)] == 9


@pytest.mark.parametrize(
    ("parts", "load", "settings"),
    [
        (plate(), on_floor(0.0036), {**CANDY, "containability.contact.lateral_friction": 0.2}),
        (plate(), on_floor(0.0036), {**CANDY, "containability.contact.lateral_friction": 0.5}),
        (walled(0.004), on_floor(RADIUS_M)[4:5], BALL),
    ],
    ids=["slides at 11 degrees", "slides at 27 degrees", "rolls over a wall"],
)
def test_a_slow_push_drives_out_what_its_tilt_does(parts, load, settings, monkeypatch):
    """Sideways acceleration a with gravity g: a field turned by atan(a / g) and stronger by 1 / cos."""
    tilted = half_gone_deg(n_left(parts, load, settings))
    monkeypatch.setattr(
        retention,
        "tilted_gravity_m_s2",
        lambda tilt, direction: tilted_gravity_m_s2(tilt, direction) / max(cos(tilt), 0.05),
    )
    assert abs(half_gone_deg(n_left(parts, load, settings)) - tilted) <= STEP_DEG + 1e-6


def test_the_field_has_gravitys_strength_and_pulls_to_the_side_that_sinks():
    field = tilted_gravity_m_s2(radians(30), radians(90))
    assert field == pytest.approx([0, 9.81 / 2, -9.81 * sqrt(3) / 2])


def test_the_largest_tilt_is_tried_too():
    angles = tilt_angles_rad(SETTINGS)
    assert len(angles) == 31
    assert angles[-1] == pytest.approx(np.pi / 2)
