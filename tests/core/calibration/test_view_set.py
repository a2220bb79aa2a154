from dataclasses import replace

import numpy as np
import pytest

from core.calibration.detection import with_square
from core.calibration.diversity import Grade, diversity
from core.calibration.hand_eye import calibrate_hand_eye
from core.calibration.rig import exp_pose
from core.calibration.view_set import why_too_little, why_wrong
from core.geometry import make_pose
from tests.core.calibration.board_views import (
    BOARD,
    INTRINSICS,
    T_BASE_BOARD,
    T_FLANGE_CAMERA,
    diverse_views,
    similar_views,
)


def graded(views):
    return diversity([view.T_base_flange for view in views], T_FLANGE_CAMERA)


def scaled(views, board):
    share = board.square_m / BOARD.square_m
    poses = [make_pose(v.T_camera_board[:3, :3], share * v.T_camera_board[:3, 3]) for v in views]
    return [replace(view, T_camera_board=pose) for view, pose in zip(views, poses, strict=True)]


def test_good_views_are_not_complained_about():
    for seed in range(5):
        views = diverse_views(15, seed)
        fit = calibrate_hand_eye(views, BOARD, INTRINSICS)
        assert why_too_little(views, T_FLANGE_CAMERA) is None
        assert why_wrong(fit, views, BOARD) is None
    assert graded(views).grade is Grade.GOOD and graded(views).missing == ()


def test_too_few_views_are_refused():
    assert why_too_little(diverse_views(5), T_FLANGE_CAMERA) == (
        "5 views of the board are too few; take at least 6, better 15 to 25."
    )
    assert why_too_little([], T_FLANGE_CAMERA).startswith("0 views")


def test_similar_views_are_refused_and_the_missing_rotations_named():
    said = why_too_little(similar_views(12, largest_rad=np.radians(8)), T_FLANGE_CAMERA)
    assert said.startswith("The views are too similar") and "rolling" in said and said.endswith(".")


@pytest.mark.parametrize(("axis", "named"), [(0, "nodding"), (1, "swinging"), (2, "rolling")])
def test_rotations_about_one_axis_only_lack_the_others(axis, named):
    found = graded(similar_views(12, largest_rad=np.radians(35), axes=np.eye(3)[axis]))
    assert found.grade is Grade.POOR
    assert len(found.missing) == 2 and not any(named in missing for missing in found.missing)
    assert found.about_rad[axis] == max(found.about_rad)


@pytest.mark.parametrize("shift_m", [0.004, 0.02])
def test_a_board_that_moved_is_noticed_with_its_views(shift_m):
    moved = T_BASE_BOARD @ exp_pose(np.array([0, 0, 0.01, shift_m, 0, 0]))
    later = [replace(v, name=f"later {v.name}") for v in diverse_views(8, 6, T_base_board=moved)]
    views = [*diverse_views(12, 5), *later]
    said = why_wrong(calibrate_hand_eye(views, BOARD, INTRINSICS), views, BOARD)
    assert said.startswith("The board moved between view 11 and later view 0")
    assert f"by {shift_m * 1000:.0f}" in said


@pytest.mark.parametrize("square_m", [0.0285, 0.0297, 0.0303, 0.0306, 0.025])
def test_squares_of_another_size_than_entered_are_measured(square_m):
    entered = with_square(BOARD, square_m)
    views = scaled(diverse_views(20, 7), entered)
    said = why_wrong(calibrate_hand_eye(views, entered, INTRINSICS), views, entered)
    assert f"not {square_m * 1000:.2f} mm" in said
    measured_mm = float(said.split(" are ")[1].split(" mm")[0])
    assert measured_mm == pytest.approx(30.0, abs=0.1)


def test_right_squares_are_never_said_to_be_others():
    for seed in range(20, 50):
        views = diverse_views(10, seed)
        assert why_wrong(calibrate_hand_eye(views, BOARD, INTRINSICS), views, BOARD) is None


def test_a_quarter_of_contradicting_views_is_refused():
    views = diverse_views(16, 8)
    random = np.random.default_rng(0)
    for k in (1, 4, 7, 10, 13):
        push = exp_pose(np.concatenate([random.normal(0, 0.1, 3), random.normal(0, 0.05, 3)]))
        views[k] = replace(views[k], T_base_flange=views[k].T_base_flange @ push)
    fit = calibrate_hand_eye(views, BOARD, INTRINSICS)
    said = why_wrong(fit, views, BOARD)
    assert said is not None and said.endswith(".")
