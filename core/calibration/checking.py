"""An independent check: the board, moved elsewhere, must be at one and the same place from all sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.hand_eye import HandEyeFit
from core.calibration.noise import pose_errors
from core.calibration.rig import BOARD, HAND_EYE, Rig, all_derivatives
from core.calibration.views import BoardView
from core.geometry import FloatArray, transform_points

FEWEST_VIEWS = 4
MOST_RATIO = 2.0
_STEPS = 3


@dataclass(frozen=True)
class Agreement:
    """How well views agree on where a board lies that the fit has not seen there.

    Attributes:
        rms_m: root mean square distance of the board's middle, as each view has it, from their mean.
        worst_m: largest distance between any two of them.
        ratio: root mean square of the views' errors in units of what the calibration leads to expect.
    """

    rms_m: float
    worst_m: float
    ratio: float

    @property
    def is_good(self) -> bool:
        """Whether the errors are as the calibration states."""
        return self.ratio <= MOST_RATIO


def check_agreement(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> Agreement:
    """Compare what views (at least two) of a still board say of its place; the fit is not changed."""
    boards = _boards(fit, views)
    middles = np.array([transform_points(pose, board.center_m) for pose in boards])
    apart = np.linalg.norm(middles[:, None] - middles[None], axis=-1)
    rms_m = float(np.sqrt((np.linalg.norm(middles - middles.mean(axis=0), axis=1) ** 2).mean()))
    _, ratio = locate_board(fit, views, board)
    return Agreement(rms_m, float(apart.max()), ratio)


def locate_board(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> tuple[FloatArray, float]:
    """Return where a still board lies, by views of it (at least two) and a hand-eye pose that is not changed.

    Returns:
        `T_base_board` (4, 4), and the views' errors as `Agreement.ratio`.
    """
    rig = Rig(fit.T_flange_camera, _boards(fit, views)[0], fit.rig.intrinsics)
    ratio = 0.0
    for _ in range(_STEPS):
        poses = pose_errors(all_derivatives(rig, board, views))
        by_hand_eye, by_board = poses.by_unknowns[..., HAND_EYE], poses.by_unknowns[..., BOARD]
        spread = by_hand_eye @ fit.hand_eye_covariance @ np.swapaxes(by_hand_eye, -1, -2)
        solved = np.linalg.solve(
            poses.covariances(fit.noise) + spread,
            np.concatenate([by_board, poses.errors[..., None]], axis=-1),
        )
        information = np.einsum("vik,vil->kl", by_board, solved[..., :6])
        step = np.linalg.solve(information, np.einsum("vik,vi->k", by_board, solved[..., 6]))
        freedom = 6 * (len(views) - 1)
        ratio = float(np.sqrt(np.einsum("vi,vi->", poses.errors, solved[..., 6]) / freedom))
        rig = rig.changed(np.concatenate([np.zeros(6), -step]))
    return rig.T_base_board, ratio


def _boards(fit: HandEyeFit, views: Sequence[BoardView]) -> list[FloatArray]:
    """Where each view alone has the board."""
    return [view.T_base_flange @ fit.T_flange_camera @ view.T_camera_board for view in views]
