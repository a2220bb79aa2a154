from dataclasses import replace

import numpy as np
import pytest

from core.calibration.accuracy import bounds, hold_out
from core.calibration.hand_eye import calibrate_hand_eye, closed_form, guessed_rig
from core.calibration.rig import Rig, derivatives, exp_pose, log_pose, residuals_px, right_jacobian
from core.errors import StageError
from core.geometry import invert_pose
from core.scan.model import Intrinsics
from tests.core.calibration.board_views import (
    BOARD,
    INTRINSICS,
    T_BASE_BOARD,
    T_FLANGE_CAMERA,
    diverse_views,
    similar_views,
)

PLACE_M = np.array([-0.06, -0.35, 0.08])


def error_of(found):
    change = log_pose(invert_pose(found) @ T_FLANGE_CAMERA)
    return np.linalg.norm(change[3:]), np.linalg.norm(change[:3])


def bounds_of(fit, views):
    return bounds(fit, np.array([view.T_base_flange for view in views]), PLACE_M)


def test_without_noise_the_hand_eye_pose_is_found_exactly():
    fit = calibrate_hand_eye(diverse_views(8, arm=(0, 0), corner_px=0.0), BOARD, INTRINSICS)
    assert error_of(fit.T_flange_camera) == pytest.approx((0, 0), abs=1e-6)
    assert np.allclose(fit.rig.T_base_board, T_BASE_BOARD, atol=1e-6)


def test_derivatives_are_those_of_the_residuals():
    view = diverse_views(1)[0]
    rig = Rig(T_FLANGE_CAMERA, T_BASE_BOARD, INTRINSICS)
    found = derivatives(rig, BOARD, view, 16)
    for k, step in enumerate(1e-6 * np.eye(16)):
        both = [residuals_px(rig.changed(s * step), BOARD, view) for s in (1, -1)]
        assert np.allclose((both[0] - both[1]) / 2e-6, found.by_unknowns[:, k], rtol=1e-4, atol=1e-3)
    for k, step in enumerate(1e-6 * np.eye(6)):
        moved = [replace(view, T_base_flange=view.T_base_flange @ exp_pose(s * step)) for s in (1, -1)]
        both = [residuals_px(rig, BOARD, there) for there in moved]
        assert np.allclose((both[0] - both[1]) / 2e-6, found.by_flange[:, k], rtol=1e-4, atol=1e-3)


def test_a_further_change_follows_by_the_right_jacobian():
    change, step = np.array([0.3, -0.5, 0.8, 0.1, 0.2, -0.1]), 1e-6 * np.arange(1, 7)
    further = log_pose(invert_pose(exp_pose(change)) @ exp_pose(change + step))
    assert np.allclose(further, right_jacobian(change) @ step, rtol=1e-4, atol=1e-11)


def test_the_joint_adjustment_beats_the_closed_form_and_its_bounds_hold():
    ours, parks, inside = [], [], 0
    for seed in range(12):
        views = diverse_views(20, seed)
        fit = calibrate_hand_eye(views, BOARD, INTRINSICS)
        ours.append(error_of(fit.T_flange_camera)[0])
        parks.append(error_of(closed_form(views))[0])
        inside += ours[-1] <= bounds_of(fit, views).position_m
    assert np.median(ours) < 0.75 * np.median(parks)
    assert np.median(ours) < 0.0005
    assert inside >= 10


def test_the_noise_is_told_by_the_views():
    sharp = calibrate_hand_eye(diverse_views(25, 1, arm=(5e-4, 3e-4)), BOARD, INTRINSICS)
    loose = calibrate_hand_eye(diverse_views(25, 1, arm=(3e-3, 2e-3)), BOARD, INTRINSICS)
    assert sharp.noise.corner_px == pytest.approx(0.2, rel=0.1)
    assert sharp.noise.arm_position_m == pytest.approx(3e-4, rel=0.5)
    assert loose.noise.arm_position_m == pytest.approx(2e-3, rel=0.4)
    assert loose.noise.arm_angle_rad == pytest.approx(3e-3, rel=0.4)


def test_a_view_in_which_the_arm_was_pushed_loses_its_weight():
    views = diverse_views(20, 3)
    pushed = views[7].T_base_flange @ exp_pose(np.array([0, 0.02, 0, 0, 0.004, 0]))
    views[7] = replace(views[7], T_base_flange=pushed)
    fit = calibrate_hand_eye(views, BOARD, INTRINSICS)
    assert fit.weights.argmin() == 7 and fit.weights[7] < 0.1
    assert np.sort(fit.weights)[1] > 0.5
    assert error_of(fit.T_flange_camera)[0] < 0.001


def test_similar_views_have_wide_bounds():
    views = similar_views(6)
    fit = calibrate_hand_eye(views, BOARD, INTRINSICS)
    assert bounds_of(fit, views).position_m > 0.003


def test_views_the_fit_did_not_see_are_foretold_as_well_as_is_stated():
    views = diverse_views(20, 4)
    held_out = hold_out(calibrate_hand_eye(views, BOARD, INTRINSICS), views, BOARD)
    assert 0.7 < held_out.ratio < 1.4
    assert 0.0002 < held_out.position_m < 0.0015


def test_wrong_intrinsics_are_put_right_when_they_are_adjusted():
    wrong = Intrinsics(INTRINSICS.fx * 1.006, INTRINSICS.fy * 1.006, INTRINSICS.cx + 3, INTRINSICS.cy)
    views = diverse_views(25, 2)
    as_given = calibrate_hand_eye(views, BOARD, wrong)
    adjusted = calibrate_hand_eye(views, BOARD, wrong, adjust_intrinsics=True)
    assert adjusted.rig.intrinsics.fx == pytest.approx(INTRINSICS.fx, rel=0.002)
    assert error_of(adjusted.T_flange_camera)[0] < 0.5 * error_of(as_given.T_flange_camera)[0]
    assert bounds_of(adjusted, views).position_m > error_of(adjusted.T_flange_camera)[0]


def test_one_view_makes_a_rough_guess_good_enough_to_aim():
    views = diverse_views(5, 6)
    guess = T_FLANGE_CAMERA @ exp_pose(np.array([0.1, -0.08, 0.05, 0.01, 0.01, -0.01]))
    rough = [error_of(guessed_rig(guess, views[:n], BOARD, INTRINSICS).T_flange_camera)[1] for n in (1, 5)]
    assert rough[1] < 0.2 * rough[0]


def test_views_without_any_rotation_are_refused():
    view = similar_views(1)[0]
    shifted = [
        replace(view, T_base_flange=view.T_base_flange @ exp_pose(np.array([0, 0, 0, 0.01 * k, 0, 0])))
        for k in range(4)
    ]
    with pytest.raises(StageError, match="do not determine"):
        calibrate_hand_eye(shifted, BOARD, INTRINSICS)
