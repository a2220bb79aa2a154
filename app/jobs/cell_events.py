"""Events of setting up a cell in a host process."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray


@dataclass(frozen=True, eq=False)
class LooksPlanned:
    """From where the arm will look at the board next, in its order.

    Attributes:
        T_base_camera: (N, 4, 4) as far as the camera's place is known.
    """

    T_base_camera: FloatArray


@dataclass(frozen=True, eq=False)
class BoardSought:
    """What became of one look at the board.

    Attributes:
        number: of the look, from 1.
        n_usable: usable looks by now.
        problem: why this one is not used; empty if it is.
        T_base_camera: (4, 4) from where, as far as the camera's place is known.
        T_base_board: (4, 4) where it has the board; none if that was not seen.
        corners_px: (C, 2) what was seen of it.
        color: (H, W, 3) uint8, RGB; none if there is no image.
    """

    number: int
    n_usable: int
    problem: str
    T_base_camera: FloatArray
    T_base_board: FloatArray | None
    corners_px: FloatArray
    color: npt.NDArray[np.uint8] | None


@dataclass(frozen=True, eq=False)
class CameraSeen:
    """What the camera sees now.

    Attributes:
        color: (H, W, 3) uint8, RGB.
        depth_m: (H, W) along the camera's axis; 0 where there is none.
    """

    color: npt.NDArray[np.uint8]
    depth_m: npt.NDArray[np.float32]
