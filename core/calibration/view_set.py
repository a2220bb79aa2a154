"""What is wrong with a set of views as a whole: too few, too similar, a board that moved, other squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.detection import with_square
from core.calibration.diversity import Grade, diversity
from core.calibration.hand_eye import OUTLIER_WEIGHT, HandEyeFit, fit_rig
from core.calibration.noise import EXPECTED, pose_errors
from core.calibration.rig import BOARD, N_POSES, all_derivatives
from core.calibration.views import BoardView
from core.geometry import FloatArray

FEWEST_VIEWS = 6
_SIDE = 3
"""Fewer views than this on one side of a move do not tell one."""
_SURE = 8.0
"""An F-statistic beyond this is no chance, though the best of many splits is taken."""
_MOVED_M, _MOVED_RAD = 0.002, np.radians(0.5)
"""Less cannot be told from what the arm's own kinematics do; the covariance grows with it."""
_OTHER_SQUARE = 0.004
_SURE_SQUARE = 16.0
"""Of squares: four standard deviations. With 8 one right board in 200 would be said to be wrong; squares that
are 1 % wrong are found with 15 views, and mostly with 10 (docs/calibrating.md)."""
_MOST_OUTLIERS = 0.25
_SCALE_STEPS = 3


@dataclass(frozen=True)
class BoardMove:
    """A board that did not stay where it was.

    Attributes:
        before: name of the last view before it moved.
        after: name of the first view after.
        shift_m: how far its origin moved.
        angle_rad: how far it turned.
    """

    before: str
    after: str
    shift_m: float
    angle_rad: float


def why_too_little(views: Sequence[BoardView], T_flange_camera: FloatArray) -> str | None:
    """Return why views do not suffice for a fit, in a sentence; none if they do.

    Args:
        views: that are usable.
        T_flange_camera: (4, 4) a guess, or the fit: it names the axes.
    """
    if len(views) < FEWEST_VIEWS:
        n = "1 view of the board is" if len(views) == 1 else f"{len(views)} views of the board are"
        return f"{n} too few; take at least {FEWEST_VIEWS}, better 15 to 25."
    found = diversity([view.T_base_flange for view in views], T_flange_camera)
    if found.grade is Grade.POOR:
        wanted = ", ".join(found.missing)
        return f"The views are too similar to tell where the camera hangs; take some more after {wanted}."
    return None


def why_wrong(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> str | None:
    """Return what contradicts a fit, in a sentence that says what to do; none if nothing does."""
    move = find_board_move(fit, views, board)
    if move is not None:
        return (
            f"The board moved between {move.before} and {move.after} (by {move.shift_m * 1000:.1f} mm and "
            f"{np.degrees(move.angle_rad):.1f} degrees); fix it, and take the views anew."
        )
    square_m = find_other_square(fit, views, board)
    if square_m is not None:
        return (
            f"The arm's way says that the squares of the board are {square_m * 1000:.2f} mm, not "
            f"{board.square_m * 1000:.2f} mm; measure them again, and enter what you measured."
        )
    odd = [view.name for view, weight in zip(views, fit.weights, strict=True) if weight < OUTLIER_WEIGHT]
    if len(odd) > _MOST_OUTLIERS * len(views):
        return (
            f"{len(odd)} of {len(views)} views contradict the others ({', '.join(odd)}); see that board "
            "and camera "
            "are fixed and that nobody touches the arm, and take the views anew."
        )
    return None


def find_board_move(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> BoardMove | None:
    """Look for a move of the board between two views, taken in this order; none if it stayed."""
    errors, by_unknowns = _whitened(fit, views, board)
    n = len(views)
    best: tuple[float, int, FloatArray] | None = None
    for split in range(_SIDE, n - _SIDE + 1):
        later = np.zeros((n, 6, 6))
        later[split:] = by_unknowns[split:, :, BOARD]
        f, change = _improvement(errors, by_unknowns, later)
        if best is None or f > best[0]:
            best = f, split, change
    if best is None or best[0] < _SURE:
        return None
    _, split, change = best
    shift_m, angle_rad = float(np.linalg.norm(change[3:])), float(np.linalg.norm(change[:3]))
    if shift_m < _MOVED_M and angle_rad < _MOVED_RAD:
        return None
    return BoardMove(views[split - 1].name, views[split].name, shift_m, angle_rad)


def find_other_square(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> float | None:
    """Return the side of the squares by the arm's way from view to view, if it is not as entered."""
    now, scaled = fit, board
    f = 0.0
    for step in range(_SCALE_STEPS):
        errors, by_unknowns = _whitened(now, views, scaled)
        by_scale = _whitened_scale(now, views, scaled)
        improvement, change = _improvement(errors, by_unknowns, by_scale)
        f = improvement if step == 0 else f
        if f < _SURE_SQUARE:
            return None
        scaled = with_square(scaled, scaled.square_m * (1 + float(change[0])))
        now = fit_rig(now.rig, views, scaled, N_POSES, rounds=2)
    is_other = abs(scaled.square_m / board.square_m - 1) > _OTHER_SQUARE
    return scaled.square_m if is_other else None


def _whitened(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> tuple[FloatArray, FloatArray]:
    """Errors (V, 6) of the views and their derivatives (V, 6, 12), in units of the expected noise.

    Not of the estimated one, which has grown with what is looked for.
    """
    poses = pose_errors(all_derivatives(fit.rig, board, views))
    whiten = np.linalg.inv(np.linalg.cholesky(poses.covariances(EXPECTED)))
    return (whiten @ poses.errors[..., None])[..., 0], whiten @ poses.by_unknowns


def _whitened_scale(fit: HandEyeFit, views: Sequence[BoardView], board: BoardSpec) -> FloatArray:
    """Derivatives (V, 6, 1) of the whitened errors by the size of the squares."""
    there = all_derivatives(fit.rig, board, views)
    whiten = np.linalg.inv(np.linalg.cholesky(pose_errors(there).covariances(EXPECTED)))
    by_pose = [np.linalg.lstsq(view.by_flange, view.by_scale, rcond=None)[0] for view in there]
    return np.asarray(whiten @ np.array(by_pose)[..., None])


def _improvement(
    errors: FloatArray, by_unknowns: FloatArray, further: FloatArray
) -> tuple[float, FloatArray]:
    """F-statistic of further unknowns (V, 6, K), and what they come to (K,)."""
    y, first = errors.ravel(), by_unknowns.reshape(-1, N_POSES)
    more = further.reshape(len(y), -1)
    both = np.hstack([first, more])
    without = y - first @ np.linalg.lstsq(first, y, rcond=None)[0]
    solution = np.linalg.lstsq(both, y, rcond=None)[0]
    rest = y - both @ solution
    gain = (without @ without - rest @ rest) / more.shape[1]
    freedom = max(len(y) - both.shape[1], 1)
    change = -np.asarray(solution[N_POSES:], dtype=float)
    return float(gain / max(rest @ rest / freedom, 1e-12)), change
