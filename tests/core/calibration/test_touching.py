"""A tip on a corner of the board: which corner it is, and how far beside it."""

import numpy as np
import pytest

from core.calibration.board import BoardSpec
from core.calibration.rig import exp_pose
from core.calibration.touching import MOST_OFF_M, MOST_SHARE, touched_corner
from core.errors import StageError
from core.geometry import invert_pose, transform_points

BOARD = BoardSpec()
T_BASE_BOARD = exp_pose(np.array([0.2, -3.0, 0.1, -0.1, -0.4, 0.03]))
T_BASE_FLANGE = exp_pose(np.array([2.0, 1.0, -0.5, -0.2, -0.3, 0.25]))


def tip_at(corner, off_m):
    """The tip, in the flange frame, that is so far beside a corner."""
    point_m = transform_points(T_BASE_BOARD, BOARD.corners_m[corner]) + off_m
    return transform_points(invert_pose(T_BASE_FLANGE), point_m)


@pytest.mark.parametrize("corner", range(BOARD.n_corners))
def test_the_nearest_corner_is_the_one_that_is_touched(corner):
    off_m = np.random.default_rng(corner).normal(0, 0.002, 3)
    touch = touched_corner(T_BASE_FLANGE, tip_at(corner, off_m), T_BASE_BOARD, BOARD)
    assert touch.corner == corner
    np.testing.assert_allclose(touch.off_m, off_m, atol=1e-12)
    assert touch.is_good == (np.linalg.norm(off_m) <= MOST_OFF_M)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_tip_between_corners_is_refused(share):
    off_m = T_BASE_BOARD[:3, 0] * BOARD.square_m * MOST_SHARE * share
    if share < 1:
        assert touched_corner(T_BASE_FLANGE, tip_at(9, off_m), T_BASE_BOARD, BOARD).corner == 9
        return
    with pytest.raises(StageError, match="11 mm from the nearest corner"):
        touched_corner(T_BASE_FLANGE, tip_at(9, off_m), T_BASE_BOARD, BOARD)
