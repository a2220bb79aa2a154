from __future__ import annotations

import numpy as np
import pytest

from app.gui.views.scene.camera import Camera

SIZE = (900, 600)
POINTS = np.random.default_rng(3).uniform(-0.2, 0.3, (40, 3))


@pytest.mark.parametrize("direction", ["iso", "top", "front", "side"])
def test_the_centre_of_the_view_shows_the_centre(direction):
    camera = Camera(center_m=(0.1, -0.2, 0.3)).looking_from(direction)
    assert camera.project(np.array([[0.1, -0.2, 0.3]]), SIZE)[0] == pytest.approx((450, 300))


@pytest.mark.parametrize(
    ("direction", "right", "up"), [("top", "x", "y"), ("front", "x", "z"), ("side", "y", "z")]
)
def test_named_views_show_the_axes_where_people_expect_them(direction, right, up):
    camera = Camera().looking_from(direction)
    axes = dict(zip("xyz", np.eye(3) * 0.1, strict=True))
    to_right, upwards = camera.project(np.array([axes[right], axes[up]]), SIZE) - (450, 300)
    assert to_right[0] > 20 and abs(to_right[1]) < 1e-6
    assert upwards[1] < -20 and abs(upwards[0]) < 1e-6


def test_a_ray_goes_back_through_the_pixel_it_came_from():
    camera = Camera(azimuth_deg=33, elevation_deg=12)
    ray = camera.ray((123, 456), SIZE)
    assert np.linalg.norm(ray.direction) == pytest.approx(1)
    assert camera.project(ray.at(0.7)[None], SIZE)[0] == pytest.approx((123, 456))


def test_the_matrices_agree_with_the_pixels():
    camera = Camera(center_m=(0.1, 0, 0), azimuth_deg=100, elevation_deg=40)
    points = np.column_stack([POINTS, np.ones(len(POINTS))])
    clip = points @ (camera.projection(SIZE) @ camera.T_eye_world).T
    flat = clip[:, :2] / clip[:, 3:]
    pixels = np.column_stack([(1 + flat[:, 0]) * 450, (1 - flat[:, 1]) * 300])
    assert pixels == pytest.approx(camera.project(POINTS, SIZE))


def test_what_is_behind_the_eye_has_no_pixel():
    camera = Camera()
    behind = camera.eye_m + camera.axes[2]
    assert np.isnan(camera.project(behind[None], SIZE)).all()


@pytest.mark.parametrize("size", [(900, 600), (300, 700)])
@pytest.mark.parametrize("direction", ["iso", "top", "side"])
def test_fitted_points_fill_the_view_and_stay_inside(direction, size):
    camera = Camera().looking_from(direction).fitted(POINTS, size)
    share = camera.project(POINTS, size) / size
    assert share.min() > 0 and share.max() < 1
    assert (share.max(axis=0) - share.min(axis=0)).max() > 0.8
    assert (share.max(axis=0) + share.min(axis=0)) / 2 == pytest.approx((0.5, 0.5), abs=0.01)


def test_a_single_point_can_be_fitted():
    camera = Camera().fitted(np.array([[0.3, 0.2, 0.1]]), SIZE)
    assert camera.center_m == pytest.approx((0.3, 0.2, 0.1))
    assert camera.distance_m > 0


def test_turning_ends_straight_above_and_wraps_round():
    camera = Camera(azimuth_deg=170, elevation_deg=80).turned(20, 30)
    assert camera.azimuth_deg == pytest.approx(-170)
    assert camera.elevation_deg == 90


def test_panning_moves_the_centre_under_the_mouse():
    camera = Camera(center_m=(0.1, 0.2, 0.3), elevation_deg=50)
    pixel = camera.panned(30, -40, SIZE).project(np.array([[0.1, 0.2, 0.3]]), SIZE)[0]
    assert pixel == pytest.approx((480, 260))


@pytest.mark.parametrize("factor", [0.5, 0.9, 1.3])
def test_zooming_at_a_pixel_keeps_what_is_seen_there(factor):
    camera, pixel = Camera((0.1, -0.2, 0.05), 0.8, 30.0, 25.0), (470.0, 90.0)
    ray = camera.ray(pixel, SIZE)
    point = ray.at(camera.distance_m / float(ray.direction @ -camera.axes[2]))
    nearer = camera.zoomed_at(factor, pixel, SIZE)
    assert nearer.distance_m == pytest.approx(factor * camera.distance_m)
    np.testing.assert_allclose(nearer.project(point[None], SIZE)[0], pixel, atol=1e-6)


def test_zooming_keeps_the_eye_within_reason():
    assert Camera(distance_m=2).zoomed(0.5).distance_m == 1
    assert Camera().zoomed(1e-9).distance_m > 0
    assert Camera().zoomed(1e9).distance_m < 100
