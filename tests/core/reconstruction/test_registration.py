from __future__ import annotations

import numpy as np
import pytest

from core.geometry import look_at
from core.reconstruction.registration import STRIDE, PixelWindow, facing_image, fit_planes
from core.scan import Intrinsics, RgbdFrame
from core.scan.model import CropBox

CAMERA = Intrinsics(200.0, 210.0, 49.5, 39.5)
NORMAL = np.array([0.3, -0.5, -1.0]) / np.linalg.norm([0.3, -0.5, -1.0])
DISTANCE_M = 0.6


def slope() -> np.ndarray:
    """Depth of the plane with `-NORMAL . p = DISTANCE_M`."""
    columns, rows = np.meshgrid(np.arange(100), np.arange(80))
    rays = np.stack(
        [(columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy, np.ones((80, 100))], -1
    )
    return (DISTANCE_M / (rays @ -NORMAL)).astype(np.float32)


def test_a_plane_is_found_and_what_it_faces():
    planes = fit_planes(slope(), CAMERA, 6.0)
    assert planes.shape == (40, 50, 3)
    assert np.nanmax(np.abs(planes - -NORMAL / DISTANCE_M)) < 1e-3
    assert np.isfinite(planes[2:-2, 2:-2]).all()
    facing = facing_image(planes, (80, 100), CAMERA)
    middle = facing[40, 50]
    assert middle == pytest.approx(-NORMAL[2], abs=0.01)  # the middle pixel looks along the axis


def test_beside_an_edge_and_without_depth_there_is_no_plane():
    depth_m = np.full((80, 100), 0.6, dtype=np.float32)
    depth_m[:, 50:] = 0.5
    depth_m[:20] = 0
    planes = fit_planes(depth_m, CAMERA, 6.0)
    assert np.isnan(planes[: 20 // STRIDE]).all()
    assert np.isfinite(planes[30, 10]).all()
    assert np.isnan(planes[30, 49 // STRIDE]).any() or np.abs(planes[30, 49 // STRIDE, 2] - 1 / 0.6) < 1e-3
    assert np.isnan(fit_planes(depth_m, CAMERA, 0.4)).all()


@pytest.mark.parametrize("shape", [(79, 99), (1, 1), (80, 101)])
def test_any_size_of_image(shape):
    depth_m = np.full(shape, 0.6, dtype=np.float32)
    facing = facing_image(fit_planes(depth_m, CAMERA, 6.0), shape, CAMERA)
    assert facing.shape == shape and np.isfinite(facing).all()


@pytest.mark.parametrize("window", [PixelWindow((11, 20), (50, 61)), PixelWindow((0, 0), (0, 0))])
def test_in_a_window_the_planes_are_the_same_and_outside_there_are_none(window):
    inside = np.zeros((40, 50), dtype=bool)
    first, end = np.array(window.first) // STRIDE, -(-np.array(window.last) // STRIDE)
    inside[first[0] : end[0], first[1] : end[1]] = True
    whole, some = fit_planes(slope(), CAMERA, 6.0), fit_planes(slope(), CAMERA, 6.0, window)
    np.testing.assert_array_equal(some[inside], whole[inside])
    assert np.isnan(some[~inside]).all()


def test_the_window_of_a_box_holds_it_and_little_more():
    pose = look_at(np.array([0.5, 0.0, 0.3]), np.zeros(3))
    frame = RgbdFrame("view", np.zeros((80, 100, 3), np.uint8), slope(), pose)
    box = CropBox((-0.05, -0.03, 0.0), (0.05, 0.03, 0.08))
    window = PixelWindow.of_box(box, frame, CAMERA)
    spread = np.random.default_rng(0).uniform(box.min_m, box.max_m, (5000, 3))
    x, y, z = ((spread - pose[:3, 3]) @ pose[:3, :3]).T
    rows, columns = CAMERA.fy * y / z + CAMERA.cy, CAMERA.fx * x / z + CAMERA.cx
    assert (
        window.first[0] <= rows.min() < window.first[0] + 3
        and window.last[0] - 4 < rows.max() < window.last[0]
    )
    assert window.first[1] <= columns.min() < window.first[1] + 3
    assert window.last[1] - 4 < columns.max() < window.last[1]


def test_a_box_that_reaches_behind_the_camera_is_looked_for_everywhere():
    frame = RgbdFrame("view", np.zeros((80, 100, 3), np.uint8), slope(), np.eye(4))
    assert PixelWindow.of_box(CropBox((-1, -1, -1), (1, 1, 1)), frame, CAMERA) == PixelWindow.whole((80, 100))
