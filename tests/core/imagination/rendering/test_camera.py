from __future__ import annotations

from math import radians, tan

import numpy as np
import pytest

from core.imagination.rendering.camera import aabb_corners, frame, light_direction, view_direction


@pytest.mark.parametrize("extents", [(0.25, 0.1, 0.04), (0.08, 0.12, 0.1), (0.05, 0.05, 0.4)])
@pytest.mark.parametrize("aspect", [4 / 3, 0.5])
def test_everything_is_in_the_picture_and_fills_it(extents, aspect):
    extents = np.array(extents)
    corners = aabb_corners(np.array([0.3, -0.5, 0.1]), np.array([0.3, -0.5, 0.1]) + extents)
    forward = view_direction(extents)
    camera = frame(corners, forward, aspect)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    seen = corners - camera.eye_m
    depth = seen @ forward
    tangent = tan(radians(camera.field_of_view_deg) / 2)
    across = seen @ right / depth / (tangent * aspect)
    upright = seen @ np.cross(right, forward) / depth / tangent
    largest = max(np.abs(across).max(), np.abs(upright).max())
    assert largest == pytest.approx(0.92)
    assert camera.reach_m == pytest.approx(depth.max())


def test_the_long_side_lies_across_and_a_slender_object_is_seen_from_higher_up():
    flat, slender = view_direction(np.array([0.3, 0.1, 0.03])), view_direction(np.array([0.06, 0.06, 0.3]))
    assert abs(flat[1]) > abs(flat[0])
    assert abs(view_direction(np.array([0.1, 0.3, 0.03]))[0]) > 0.5
    assert slender[2] < flat[2] < -0.5
    assert light_direction(flat)[2] > 0.5


def test_a_camera_on_its_way_starts_and_ends_right():
    corners = aabb_corners(np.zeros(3), np.ones(3))
    wide, near = (frame(corners * size, view_direction(np.ones(3)), 1.0) for size in (2, 1))
    np.testing.assert_allclose(wide.blended(near, 0.0).eye_m, wide.eye_m)
    np.testing.assert_allclose(wide.blended(near, 1.0).eye_m, near.eye_m)
