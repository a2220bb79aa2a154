from dataclasses import replace

import numpy as np
import pytest

from core.appearance.crops import MARGIN, SIZE_PX, Square, cropped, object_square, quarter_turns
from core.appearance.looking import ViewLook, look_at_scan, look_at_view, top_down_view
from core.appearance.network import Look, Network
from core.geometry import look_at, make_pose, rotation_z
from core.scan.model import CropBox, Scan
from tests.core.appearance.looks import BOX, INTRINSICS, block_frame, drawn_network


def test_the_square_is_around_what_lies_in_the_box():
    square = object_square(block_frame(300, 200, 80, 40), INTRINSICS, BOX)
    assert square.side_px == pytest.approx(MARGIN * 80, abs=2)
    assert square.left_px + square.side_px / 2 == pytest.approx(340, abs=1)
    assert square.top_px + square.side_px / 2 == pytest.approx(220, abs=1)


def test_single_wrong_depths_do_not_move_the_square():
    frame = block_frame(300, 200, 80, 80)
    frame.depth_m[10, 600] = frame.depth_m[300, 340] = frame.depth_m[200, 300]
    square = object_square(frame, INTRINSICS, BOX)
    assert square.side_px == pytest.approx(MARGIN * 80, abs=3)


def test_a_view_without_the_object_has_no_square():
    assert object_square(block_frame(0, 0, 0, 0), INTRINSICS, BOX) is None


def test_a_crop_shows_the_square_and_repeats_the_border_beyond_the_image():
    frame = block_frame(0, 100, 60, 60)
    crop = cropped(frame.color, Square(-60.0, 70.0, 120.0))
    assert crop.shape == (SIZE_PX, SIZE_PX, 3) and crop.dtype == np.float32
    assert crop[48, :90] == pytest.approx(230 / 255, abs=0.01), "the block touches the left border"
    assert crop[5, 48] == pytest.approx(40 / 255, abs=0.01)


def test_cells_lie_where_pixels_say():
    contain = np.zeros((48, 48), dtype=np.float32)
    contain[0, 47] = 0.9
    view = ViewLook(Square(100.0, 50.0, 96.0), Look(0.5, contain))
    rows, columns = np.nonzero(view.contain_map((480, 640)))
    assert set(rows) == {50, 51} and set(columns) == {194, 195}
    places = Square(100.0, 50.0, 96.0).pixels(np.array([[47, 0]]), 48)
    assert places[0] == pytest.approx([194.5, 50.5])


def test_the_overlay_is_green_where_it_contains_and_nothing_else_changes():
    contain = np.zeros((48, 48), dtype=np.float32)
    contain[20:30, 20:30] = 1.0
    view = ViewLook(Square(580.0, 400.0, 96.0), Look(0.5, contain))  # partly beyond the image
    color = np.full((480, 640, 3), 100, dtype=np.uint8)
    drawn = view.overlaid(color)
    assert (drawn[:390, :570] == 100).all(), "outside the square"
    assert drawn[445, 639, 1] > drawn[445, 639, 0]
    assert (color == 100).all()


@pytest.mark.parametrize("degrees", [-170, -90, -40, 0, 40, 90, 180])
def test_a_view_is_turned_so_that_up_is_up(degrees):
    """The camera looks at a pole's top, above the middle, while it is turned about its own axis."""
    roll = make_pose(rotation_z(np.deg2rad(degrees)), np.zeros(3))
    T_base_camera = look_at([0.6, 0.2, 0.3], [0, 0, 0]) @ roll
    x, y, z = (np.linalg.inv(T_base_camera) @ [0, 0, 0.1, 1])[:3]
    image = np.zeros((101, 101))
    image[round(50 + 200 * y / z), round(50 + 200 * x / z)] = 1
    row, column = np.argwhere(np.rot90(image, quarter_turns(T_base_camera)))[0] - 50
    assert row < 0 and abs(column) <= abs(row) + 1


class _Brightness(Network):
    """Where it is bright, something contains; only an upright view is bright in its upper half."""

    def look(self, crop: np.ndarray) -> Look:
        shown = crop[::2, ::2].mean(axis=-1)
        return Look(float(shown[:24].mean() - shown[24:].mean()), shown)


def test_the_network_sees_a_view_upright_and_its_map_lies_over_the_image_as_it_was():
    frame = block_frame(300, 200, 80, 80)
    frame.color[200:240, 300:380] = 60  # the lower half of the block is bright
    camera = look_at([0.3, 0, 0.5], [0, 0, 0.05])
    upside_down = camera @ make_pose(rotation_z(np.pi), np.zeros(3))
    box = CropBox((-2, -2, -2), (2, 2, 2))
    for pose, sign in ((camera, -1), (upside_down, 1)):
        look = look_at_view(_Brightness({}), replace(frame, T_base_camera=pose), INTRINSICS, box)
        assert np.sign(look.look.score) == sign
        contains = look.contain_map(frame.depth_m.shape) > 0.5
        assert contains[258, 340] and not contains[218, 340]


def test_each_view_is_looked_at_and_the_steepest_one_is_from_above():
    above = block_frame(300, 200, 80, 80)
    aside = replace(above, name="frame-000001", T_base_camera=look_at([0.5, 0, 0.5], [0, 0, 0]))
    away = replace(above, name="frame-000002", T_base_camera=look_at([0.5, 0, 0.5], [2, 0, 0]))
    scan = Scan((aside, above, away), INTRINSICS, crop_box=BOX)
    looks = look_at_scan(drawn_network(), scan, BOX)
    assert [look is None for look in looks] == [False, False, True]
    assert top_down_view(scan) == 1
