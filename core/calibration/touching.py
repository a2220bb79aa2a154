"""A touch check: a pointed tool on a corner of the board says where that corner is without the camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.errors import StageError
from core.geometry import FloatArray, transform_points

MOST_SHARE = 1 / 3
"""Of a square: a tip that is farther from the nearest corner may as well have been meant for another one."""
MOST_OFF_M = 0.003
"""As much as a calibration may be off at the place of pouring."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Where the tip of a tool was that touched a corner.

    Attributes:
        corner: its number on the board.
        off_m: (3,) from the corner, as the calibrated camera has it, to the tip, in the base frame.
    """

    corner: int
    off_m: FloatArray

    @property
    def distance_m(self) -> float:
        """How far apart they are."""
        return float(np.linalg.norm(self.off_m))

    @property
    def is_good(self) -> bool:
        """Whether the calibration holds by this."""
        return self.distance_m <= MOST_OFF_M


def touched_corner(
    T_base_flange: FloatArray, tip_m: FloatArray, T_base_board: FloatArray, board: BoardSpec
) -> Touch:
    """Say which corner a tip touches, and how far beside it the tip is.

    Args:
        T_base_flange: (4, 4) by the arm's own kinematics.
        tip_m: (3,) the tip in the flange frame.
        T_base_board: (4, 4) where the camera has the board.
        board: its size.

    Raises:
        StageError: no corner is near enough to tell.
    """
    off_m = transform_points(T_base_flange, tip_m) - transform_points(T_base_board, board.corners_m)
    corner = int(np.linalg.norm(off_m, axis=1).argmin())
    touch = Touch(corner, off_m[corner])
    if touch.distance_m > MOST_SHARE * board.square_m:
        raise StageError(
            f"The tip is {1000 * touch.distance_m:.0f} mm from the nearest corner of the board; put it onto "
            "a corner where two black squares meet, and see that the tip's place at the flange is right and "
            "the board was not moved since the check."
        )
    return touch
