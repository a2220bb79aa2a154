from functools import cache

import numpy as np
import pytest

from core.calibration.board import BoardSpec
from core.calibration.detection import detect_board, gray, measured_square_m, with_square
from core.calibration.lens import Lens, project
from core.calibration.views import board_view, edge_blur_px, why_unusable
from core.errors import StageError
from core.geometry import invert_pose, look_at, make_pose, rotation_z, transform_points
from hardware.simulation.board_view import BoardLook, BoardPainter, lying_board
from tests.core.calibration.board_views import BOARD, INTRINSICS

LENS = Lens(INTRINSICS)
BENT = Lens(INTRINSICS, (0.1, -0.2, 0.001, -0.001, 0.0))
T_WORLD_BOARD = lying_board(BOARD, np.zeros(3), 0.4)
EYE = (0.15, -0.1, 0.45)
CLEAN = BoardLook()
NOWHERE = np.eye(4)


@cache
def painter(board, lens):
    return BoardPainter(board, lens, (640, 480))


def seen(eye=EYE, target=(0, 0, 0), board=BOARD, lens=LENS, look=CLEAN, roll_rad=0.0, seed=0):
    camera = look_at(np.array(eye, float), np.array(target, float))
    T = invert_pose(camera @ make_pose(rotation_z(roll_rad), (0, 0, 0))) @ T_WORLD_BOARD
    grey = np.full((480, 640, 3), 150, np.uint8)
    color, depth = painter(board, lens).paint(grey, T, look, np.random.default_rng(seed))
    return gray(color), depth, T


def judged(image, taken=(), T_base_flange=NOWHERE, board=BOARD, lens=LENS):
    return why_unusable(detect_board(image, board, lens), image, board, lens, T_base_flange, taken)


@pytest.mark.parametrize("lens", [LENS, BENT])
def test_corners_are_found_to_a_tenth_of_a_pixel_through_any_lens(lens):
    image, _, T = seen(lens=lens)
    found = detect_board(image, BOARD, lens)
    truth = project(INTRINSICS, transform_points(T, BOARD.corners_m[found.ids]))
    assert len(found.ids) == BOARD.n_corners
    assert np.abs(found.corners_px - truth).mean() < 0.1
    assert np.linalg.norm(found.T_camera_board[:3, 3] - T[:3, 3]) < 0.001
    assert judged(image, lens=lens) is None


def test_an_image_without_a_board_says_so():
    with pytest.raises(StageError, match="No board was found"):
        detect_board(np.full((480, 640), 150, np.uint8), BOARD, LENS)


def test_markers_of_another_dictionary_are_named():
    image, _, _ = seen(board=BoardSpec(dictionary="5X5_50"))
    with pytest.raises(StageError, match=r"dictionary 5X5_\d+, and the board of this cell of 4X4_50"):
        detect_board(image, BOARD, LENS)


def test_a_mirrored_print_is_recognized():
    image, _, _ = seen(look=BoardLook(is_mirrored=True))
    with pytest.raises(StageError, match="mirrored"):
        detect_board(image, BOARD, LENS)


def test_another_number_of_squares_is_suspected():
    image, _, _ = seen(board=BoardSpec(columns=7, rows=5))
    with pytest.raises(StageError, match="check that it has 8 x 5 squares"):
        detect_board(image, BOARD, LENS)


def test_a_board_that_reaches_out_of_the_image_is_cut_off():
    image, _, _ = seen(eye=(0.15, -0.1, 0.4), target=(0.2, 0.08, 0))
    assert "cut off at the" in judged(image)


def test_frontal_views_are_refused():
    image, _, _ = seen(eye=(0, 0.02, 0.5))
    assert "from the front" in judged(image)


def test_blur_is_measured_and_refused():
    sharp, _, _ = seen(look=BoardLook(blur_px=0.4))
    soft, _, _ = seen(eye=(0.12, -0.08, 0.36), look=BoardLook(blur_px=1.25))
    blurs = [edge_blur_px(detect_board(image, BOARD, LENS), image, BOARD, LENS) for image in (sharp, soft)]
    assert blurs[0] < 0.9 and blurs[1] > 1.2
    assert "blurred" in judged(soft)


def test_a_camera_that_moves_during_the_exposure_blurs_one_direction():
    near = (0.12, -0.08, 0.36)
    still, _, _ = seen(eye=near)
    moving, _, _ = seen(eye=near, look=BoardLook(motion_px=(3.0, 0.0)))
    blurs = [edge_blur_px(detect_board(image, BOARD, LENS), image, BOARD, LENS) for image in (still, moving)]
    assert blurs[1] > blurs[0] + 0.2


def test_a_repeated_view_is_refused():
    image, _, _ = seen()
    pose = make_pose(np.eye(3), (0.1, 0.2, 0.3))
    first = board_view("view 3", pose, detect_board(image, BOARD, LENS))
    near = pose @ make_pose(rotation_z(0.02), (0.003, 0, 0))
    assert judged(image, [first], near) == (
        "The view repeats view 3; turn the camera to where it has not been."
    )
    assert judged(image, [first], pose @ make_pose(rotation_z(0.5), (0, 0, 0))) is None


def test_the_depth_image_measures_the_squares():
    image, depth, _ = seen()
    entered = with_square(BOARD, 0.025)
    found = detect_board(image, entered, LENS)
    depth = np.where(np.isfinite(depth), depth, 0).astype(np.float32)
    assert measured_square_m(found, entered, LENS, depth) == pytest.approx(0.030, rel=0.005)
    assert measured_square_m(found, entered, LENS, np.zeros_like(depth)) is None
