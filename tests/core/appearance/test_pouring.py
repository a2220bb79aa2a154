import numpy as np
import pytest

from core.appearance.crops import Square
from core.appearance.looking import ViewLook
from core.appearance.network import Look
from core.appearance.pouring import OFFSET_M, above_box, at_offset, contain_point
from tests.core.appearance.looks import HEIGHT_M, INTRINSICS, block_frame


def look(*cells: tuple[int, int]) -> ViewLook:
    """Contains in some cells of a square of 96 pixels in the middle of the image."""
    contain = np.zeros((48, 48), dtype=np.float32)
    for row, column in cells:
        contain[row, column] = 1.0
    return ViewLook(Square(272.0, 192.0, 96.0), Look(0.9, contain))


def test_the_centroid_is_projected_with_the_depth_there():
    """Four cells around the principal point (319.5, 239.5): straight below the camera."""
    frame = block_frame(250, 150, 150, 180)
    point = contain_point(look((23, 23), (23, 24), (24, 23), (24, 24)), frame, INTRINSICS)
    assert point == pytest.approx([0, 0, 0.1], abs=1e-6)
    aside = contain_point(look((23, 33), (24, 33)), frame, INTRINSICS)
    assert aside == pytest.approx([(HEIGHT_M - 0.1) * 19 / 500, 0, 0.1], abs=1e-6)


def test_without_a_depth_there_the_nearest_is_taken():
    frame = block_frame(250, 150, 150, 180)
    frame.depth_m[230:250, 310:330] = 0
    frame.depth_m[240, 330] = 0.45
    point = contain_point(look((23, 23), (23, 24), (24, 23), (24, 24)), frame, INTRINSICS)
    assert point[2] == pytest.approx(HEIGHT_M - 0.5, abs=1e-6)
    frame.depth_m[:] = 0
    assert contain_point(look((23, 23)), frame, INTRINSICS) is None


def test_nothing_that_contains_is_no_place():
    assert contain_point(look(), block_frame(250, 150, 150, 180), INTRINSICS) is None


def test_the_pivot_is_a_fixed_height_above_the_point_or_above_the_scanned_box():
    point = np.array([0.1, 0.2, 0.05])
    assert at_offset(point) == pytest.approx([0.1, 0.2, 0.05 + OFFSET_M])
    aabb_m = np.array([[0, 0, 0], [0.2, 0.3, 0.21]])
    assert above_box(point, aabb_m, 0.01) == pytest.approx([0.1, 0.2, 0.22])
