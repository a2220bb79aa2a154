"""How accurate a hand-eye calibration is: by its covariance at the place of pouring, and by unseen views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.hand_eye import HandEyeFit, fit_without
from core.calibration.noise import pose_errors
from core.calibration.rig import all_derivatives
from core.calibration.views import BoardView
from core.geometry import FloatArray, transform_points

CONFIDENCE = 0.95
_DRAWS = 10_000
_FOLDS = 5


@dataclass(frozen=True)
class Bounds:
    """What the error stays below in 95 of 100 calibrations such as this one.

    Attributes:
        position_m: of the camera's place at the flange.
        angle_rad: of its orientation.
        pouring_m: of where an object at the place of pouring is seen, root mean square over the scan's views.
        expected_pouring_m: the root mean square of the latter: what is to be expected.
    """

    position_m: float
    angle_rad: float
    pouring_m: float
    expected_pouring_m: float


@dataclass(frozen=True)
class HeldOut:
    """How well views are foretold that the fit did not see.

    Attributes:
        rms_px: of the corners, per coordinate.
        position_m: root mean square distance between the board's middle, as foretold and as seen.
        ratio: root mean square of the errors in units of what noise and covariance lead to expect; 1 if the
            stated accuracy is right.
    """

    rms_px: float
    position_m: float
    ratio: float


def bounds(fit: HandEyeFit, T_base_flange: FloatArray, place_m: FloatArray) -> Bounds:
    """Return the bounds of a fit.

    The errors are drawn from a t-distribution with the covariance of the fit: the noise is estimated, too.

    Args:
        fit: of the views.
        T_base_flange: (K, 4, 4) from where an object is scanned.
        place_m: (3,) where it stands, in the base frame.
    """
    random = np.random.default_rng(0)
    draws = random.standard_normal((_DRAWS, 6)) @ np.linalg.cholesky(fit.hand_eye_covariance).T
    nu = fit.degrees_of_freedom
    draws *= np.sqrt(nu / random.chisquare(nu, size=_DRAWS))[:, None]
    at_place = np.sqrt((place_errors(fit.T_flange_camera, draws, T_base_flange, place_m) ** 2).mean(axis=1))
    return Bounds(
        position_m=_quantile(np.linalg.norm(draws[:, 3:], axis=1)),
        angle_rad=_quantile(np.linalg.norm(draws[:, :3], axis=1)),
        pouring_m=_quantile(at_place),
        expected_pouring_m=float(np.sqrt((at_place**2).mean())),
    )


def place_errors(
    T_flange_camera: FloatArray, changes: FloatArray, T_base_flange: FloatArray, place_m: FloatArray
) -> FloatArray:
    """How far off (N, K) a place is seen, in metres, with changes (N, 6) of the hand-eye pose.

    Args:
        T_flange_camera: (4, 4) the hand-eye pose.
        changes: (N, 6) in the camera frame: rotation vector, then translation.
        T_base_flange: (K, 4, 4) from where it is seen.
        place_m: (3,) the place in the base frame.
    """
    in_camera = transform_points(np.eye(4), place_m) - (T_base_flange @ T_flange_camera)[:, :3, 3]
    in_camera = np.einsum("kji,kj->ki", (T_base_flange @ T_flange_camera)[:, :3, :3], in_camera)
    moved = np.cross(changes[:, None, :3], in_camera[None]) + changes[:, None, 3:]
    return np.asarray(np.linalg.norm(moved, axis=-1))


def hold_out(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> HeldOut:
    """Fit again without every fifth view, and compare it with what the others foretell, in five turns.

    Views that lost their weight count as much as the others here.
    """
    ratios, squares_px, squares_m = [], [], []
    for fold in range(_FOLDS):
        left_out = set(range(fold, len(views), _FOLDS))
        other = fit_without(fit, views, left_out, board)
        unseen = [views[k] for k in sorted(left_out)]
        there = all_derivatives(other.rig, board, unseen, len(fit.covariance))
        poses = pose_errors(there)
        spread = poses.by_unknowns @ other.covariance @ np.swapaxes(poses.by_unknowns, -1, -2)
        expected = poses.covariances(other.noise) + spread
        solved = np.linalg.solve(expected, poses.errors[..., None])[..., 0]
        ratios += (np.einsum("vi,vi->v", poses.errors, solved) / 6).tolist()
        squares_px += [float((view.residuals_px**2).mean()) for view in there]
        squares_m += [_middle_error_m(other, view, board) ** 2 for view in unseen]
    return HeldOut(_rms(squares_px), _rms(squares_m), _rms(ratios))


def _middle_error_m(fit: HandEyeFit, view: BoardView, board: BoardSpec) -> float:
    foretold = transform_points(fit.rig.T_base_board, board.center_m)
    seen = transform_points(view.T_base_flange @ fit.T_flange_camera @ view.T_camera_board, board.center_m)
    return float(np.linalg.norm(foretold - seen))


def _quantile(values: FloatArray) -> float:
    return float(np.quantile(values, CONFIDENCE))


def _rms(squares: list[float]) -> float:
    return float(np.sqrt(np.mean(squares)))
