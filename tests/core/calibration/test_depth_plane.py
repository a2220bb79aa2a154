"""How true depth is: noise is found as large as it is, whatever else is in sight."""

from __future__ import annotations

import numpy as np
import pytest

from core.calibration.depth_plane import find_plane
from core.scan.model import Intrinsics

INTRINSICS = Intrinsics(525.0, 525.0, 319.5, 239.5)


def plane_depth_m(tilt_deg: float, distance_m: float = 0.6) -> np.ndarray:
    """Depth (480, 640) of a plane tilted about the image's x-axis."""
    rows = np.arange(480)[:, None] + np.zeros((1, 640))
    slope = np.tan(np.radians(tilt_deg))
    return distance_m / (1 - slope * (rows - INTRINSICS.cy) / INTRINSICS.fy)


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0])
@pytest.mark.parametrize("noise_m", [0.0, 0.0008, 0.003])
def test_noise_is_found_as_large_as_it_is(tilt_deg, noise_m):
    depth_m = plane_depth_m(tilt_deg)
    depth_m = depth_m + np.random.default_rng(3).normal(0, noise_m, depth_m.shape)
    found = find_plane(depth_m, INTRINSICS)
    across = noise_m * np.cos(np.radians(tilt_deg))
    assert found.rms_m == pytest.approx(across, rel=0.06, abs=1e-6)
    assert found.distance_m == pytest.approx(0.6, abs=0.01)
    assert np.degrees(found.tilt_rad) == pytest.approx(tilt_deg, abs=0.3)
    assert found.is_flat and found.is_true and found.share > 0.98


def test_an_object_in_front_of_the_plane_and_holes_do_not_count():
    depth_m = plane_depth_m(20.0) + np.random.default_rng(1).normal(0, 0.001, (480, 640))
    depth_m[200:300, 250:400] -= 0.08
    depth_m[150:200, 200:450] = 0
    found = find_plane(depth_m, INTRINSICS)
    assert found.rms_m == pytest.approx(0.001 * np.cos(np.radians(20)), rel=0.06)
    assert 0.7 < found.share < 0.9


def test_depth_that_is_bent_is_not_true():
    rows, columns = np.mgrid[0:480, 0:640]
    bowl = 0.06 * (((rows - 240) / 240) ** 2 + ((columns - 320) / 320) ** 2)
    found = find_plane(plane_depth_m(0.0) + bowl, INTRINSICS)
    assert not (found.is_flat and found.is_true)


def test_noise_beyond_what_a_scan_bears_is_said():
    depth_m = plane_depth_m(10.0) + np.random.default_rng(4).normal(0, 0.009, (480, 640))
    found = find_plane(depth_m, INTRINSICS)
    assert found.is_flat and not found.is_true


def test_without_a_flat_surface_there_is_no_figure():
    random = np.random.default_rng(2)
    found = find_plane(random.uniform(0.3, 1.5, (480, 640)), INTRINSICS)
    assert not found.is_flat
    assert find_plane(np.zeros((480, 640)), INTRINSICS) is None
