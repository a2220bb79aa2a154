"""Hand-eye calibration: where the camera hangs at the flange, from views of a board that does not move.

A closed form starts it (Park and Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group",
IEEE Trans. Robotics and Automation 1994, by OpenCV). Then hand-eye pose, board pose and, if wanted, the
intrinsics are adjusted together to the corners in all images, each view weighted by what corners and arm are
worth (`noise`), and views that fit none of this lose their weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.noise import EXPECTED, Noise, PoseErrors, distances, estimate_noise, pose_errors
from core.calibration.rig import (
    BOARD,
    HAND_EYE,
    N_POSES,
    N_WITH_INTRINSICS,
    Derivatives,
    Rig,
    all_derivatives,
    log_pose,
    residuals_px,
    right_jacobian,
)
from core.calibration.views import BoardView
from core.errors import StageError
from core.geometry import FloatArray, invert_pose, make_pose
from core.scan.model import Intrinsics

_ROUNDS = 5
_USUAL = 16.8
"""99 of 100 views of the assumed noise have a smaller squared distance (chi-square, 6 degrees of freedom)."""
OUTLIER_WEIGHT = 0.5
GUESS_SD = np.array([0.1] * 3 + [0.012] * 3)
"""A rough guess is wrong by up to 10 degrees and 20 mm, all axes together."""
_INTRINSICS_PRIOR = np.array([0.01, 0.01, 5.0, 5.0])
"""The driver's figures are believed to one percent and five pixels: 20 views hardly know better."""


@dataclass(frozen=True)
class HandEyeFit:
    """What the views say.

    Attributes:
        rig: hand-eye pose, board pose and intrinsics.
        covariance: (K, K) of the unknowns' changes (`rig`), for errors as in `noise`.
        degrees_of_freedom: from which the noise was estimated.
        noise: of corners and arm.
        poses: the views' residuals as errors of the arm's pose.
        weights: (V,) of the views, 0 to 1.
        rms_px: root mean square of all corners' residuals, per coordinate, the arm's errors included.
    """

    rig: Rig
    covariance: FloatArray
    degrees_of_freedom: float
    noise: Noise
    poses: PoseErrors
    weights: FloatArray
    rms_px: float

    @property
    def T_flange_camera(self) -> FloatArray:
        """The hand-eye pose (4, 4)."""
        return self.rig.T_flange_camera

    @property
    def hand_eye_covariance(self) -> FloatArray:
        """Covariance (6, 6) of its change in the camera frame: rotation (rad), translation (m)."""
        return self.covariance[HAND_EYE, HAND_EYE]


def closed_form(views: Sequence[BoardView]) -> FloatArray:
    """Return `T_flange_camera` (4, 4) by Park's method.

    Raises:
        StageError: the arm's rotations do not determine it.
    """
    import cv2

    flange = [view.T_base_flange for view in views]
    board = [view.T_camera_board for view in views]
    turn, shift = cv2.calibrateHandEye(
        [T[:3, :3] for T in flange], [T[:3, 3] for T in flange],
        [T[:3, :3] for T in board], [T[:3, 3] for T in board],
        method=cv2.CALIB_HAND_EYE_PARK,
    )  # fmt: skip
    if not (np.isfinite(turn).all() and np.isfinite(shift).all()):
        raise StageError(
            "The views do not determine where the camera hangs; take some from poses turned about other axes."
        )
    return make_pose(turn, np.ravel(shift))


def calibrate_hand_eye(
    views: Sequence[BoardView], board: BoardSpec, intrinsics: Intrinsics, *, adjust_intrinsics: bool = False
) -> HandEyeFit:
    """Fit the rig to views.

    Args:
        views: at least three; what a set of them lacks is said by `view_set.why_unfit`.
        board: as printed.
        intrinsics: of the camera, as a pinhole.
        adjust_intrinsics: whether they are adjusted, too.

    Raises:
        StageError: the views do not determine it.
    """
    n_unknowns = N_WITH_INTRINSICS if adjust_intrinsics else N_POSES
    start = _start(views, intrinsics)
    return fit_rig(start, views, board, n_unknowns, intrinsics)


def fit_rig(
    start: Rig,
    views: Sequence[BoardView],
    board: BoardSpec,
    n_unknowns: int = N_POSES,
    believed: Intrinsics | None = None,
    rounds: int = _ROUNDS,
) -> HandEyeFit:
    """Adjust a rig that is nearly right; see `calibrate_hand_eye`."""
    rig, noise = start, EXPECTED
    weights = np.ones(len(views))
    for _ in range(rounds):
        prior = _Prior(n_unknowns, believed or start.intrinsics)
        rig = _adjusted(rig, views, board, noise, weights, prior)
        poses = pose_errors(all_derivatives(rig, board, views, n_unknowns))
        noise = estimate_noise(poses, weights)
        weights = np.minimum(_USUAL / np.maximum(distances(poses, noise), 1e-12), 1.0)
    return _result(rig, views, board, noise, weights, n_unknowns)


def _start(views: Sequence[BoardView], intrinsics: Intrinsics) -> Rig:
    T_flange_camera = closed_form(views)
    boards = np.array([view.T_base_flange @ T_flange_camera @ view.T_camera_board for view in views])
    u, _, vt = np.linalg.svd(boards[:, :3, :3].mean(axis=0))
    turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return Rig(T_flange_camera, make_pose(turn, np.median(boards[:, :3, 3], axis=0)), intrinsics)


def guessed_rig(
    T_flange_camera: FloatArray, views: Sequence[BoardView], board: BoardSpec, intrinsics: Intrinsics
) -> Rig:
    """Return what a few views, even one, make of a rough guess of the hand-eye pose (4, 4).

    It is good enough to find the board in the image from elsewhere, not to be kept.
    """
    first = views[0]
    T_base_board = first.T_base_flange @ T_flange_camera @ first.T_camera_board
    rig = Rig(T_flange_camera, T_base_board, intrinsics)
    prior = _Prior(N_POSES, intrinsics, T_flange_camera)
    return _adjusted(rig, views, board, EXPECTED, np.ones(len(views)), prior)


@dataclass(frozen=True)
class _Prior:
    """What is known besides the views: the intrinsics, if they are adjusted, and perhaps a guess.

    Attributes:
        n_unknowns: 12, or 16 with the intrinsics.
        believed: the driver's intrinsics.
        T_flange_camera: (4, 4) a rough guess, if there is one.
    """

    n_unknowns: int
    believed: Intrinsics
    T_flange_camera: FloatArray | None = None

    def residuals(self, now: Rig) -> FloatArray:
        """In units of what is believed (M,)."""
        parts = [np.zeros(0)]
        if self.n_unknowns == N_WITH_INTRINSICS:
            i, b = now.intrinsics, self.believed
            parts.append(
                np.array([i.fx / b.fx - 1, i.fy / b.fy - 1, i.cx - b.cx, i.cy - b.cy]) / _INTRINSICS_PRIOR
            )
        if self.T_flange_camera is not None:
            parts.append(log_pose(invert_pose(self.T_flange_camera) @ now.T_flange_camera) / GUESS_SD)
        return np.concatenate(parts)

    def rows(self) -> FloatArray:
        """Their derivatives (M, K), for small changes."""
        rows = np.zeros((self.n_unknowns - N_POSES, self.n_unknowns))
        if len(rows):
            rows[:, N_POSES:] = np.diag(1 / _INTRINSICS_PRIOR)
        if self.T_flange_camera is not None:
            rows = np.vstack([rows, np.eye(6, self.n_unknowns) / GUESS_SD[:, None]])
        return rows


def _adjusted(
    rig: Rig,
    views: Sequence[BoardView],
    board: BoardSpec,
    noise: Noise,
    weights: FloatArray,
    prior: _Prior,
) -> Rig:
    """One weighted adjustment of all unknowns; the weights stay as they are at its start."""
    from scipy.optimize import least_squares

    n_unknowns = prior.n_unknowns
    whiten = [
        np.sqrt(weight) * np.linalg.inv(np.linalg.cholesky(_covariance(view.by_flange, noise)))
        for view, weight in zip(all_derivatives(rig, board, views), weights, strict=True)
    ]

    def cost(change: FloatArray) -> FloatArray:
        now = rig.changed(change)
        parts = [w @ residuals_px(now, board, view) for w, view in zip(whiten, views, strict=True)]
        return np.concatenate([*parts, prior.residuals(now)])

    def jacobian(change: FloatArray) -> FloatArray:
        chain = np.eye(n_unknowns)
        chain[HAND_EYE, HAND_EYE] = right_jacobian(change[HAND_EYE])
        chain[BOARD, BOARD] = right_jacobian(change[BOARD])
        there = all_derivatives(rig.changed(change), board, views, n_unknowns)
        parts = [w @ view.by_unknowns @ chain for w, view in zip(whiten, there, strict=True)]
        return np.concatenate([*parts, prior.rows()])

    found = least_squares(cost, np.zeros(n_unknowns), jac=jacobian, method="lm", x_scale="jac")
    return rig.changed(found.x)


def _covariance(by_flange: FloatArray, noise: Noise) -> FloatArray:
    corners = noise.corner_px**2 * np.eye(len(by_flange))
    return np.asarray(corners + by_flange @ noise.arm_covariance @ by_flange.T)


def _result(
    rig: Rig, views: Sequence[BoardView], board: BoardSpec, noise: Noise, weights: FloatArray, n_unknowns: int
) -> HandEyeFit:
    there = all_derivatives(rig, board, views, n_unknowns)
    poses = pose_errors(there)
    information = weighted_information(poses, noise, weights)
    prior = _Prior(n_unknowns, rig.intrinsics).rows()
    information += prior.T @ prior
    if n_unknowns == N_WITH_INTRINSICS:
        information += _left_over_information(there, noise, weights)
    if np.linalg.cond(information) > 1e14:
        raise StageError(
            "The views do not determine where the camera hangs; take some from poses turned about other axes."
        )
    everything = np.concatenate([view.residuals_px for view in there])
    freedom = max(6 * float(weights.sum()) - N_POSES, 1.0)
    rms_px = float(np.sqrt((everything**2).mean()))
    covariance = np.asarray(np.linalg.inv(information), dtype=float)
    return HandEyeFit(rig, covariance, freedom, noise, poses, weights, rms_px)


def weighted_information(poses: PoseErrors, noise: Noise, weights: FloatArray) -> FloatArray:
    """Information (K, K) that views give on the unknowns: the inverse of a covariance."""
    solved = np.linalg.solve(poses.covariances(noise), poses.by_unknowns)
    return np.asarray(np.einsum("v,vik,vil->kl", weights, poses.by_unknowns, solved))


def _left_over_information(there: Sequence[Derivatives], noise: Noise, weights: FloatArray) -> FloatArray:
    """What the corners tell of the intrinsics beyond the board's pose in each view."""
    total = np.zeros((N_WITH_INTRINSICS, N_WITH_INTRINSICS))
    for view, weight in zip(there, weights, strict=True):
        within = view.by_flange @ np.linalg.lstsq(view.by_flange, view.by_unknowns, rcond=None)[0]
        rest = view.by_unknowns - within
        total += weight / noise.corner_px**2 * rest.T @ rest
    return total


def fit_without(
    fit: HandEyeFit, views: Sequence[BoardView], left_out: set[int], board: BoardSpec
) -> HandEyeFit:
    """Fit again without the views of some numbers, from where the fit is, with the same unknowns."""
    kept = [view for k, view in enumerate(views) if k not in left_out]
    return fit_rig(fit.rig, kept, board, len(fit.covariance), rounds=2)
