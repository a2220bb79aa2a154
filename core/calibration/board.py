"""The calibration board: a chessboard with ArUco markers in its white squares (ChArUco).

Garrido-Jurado et al., "Automatic generation and detection of highly reliable fiducial markers under
occlusion", Pattern Recognition 2014; the board is OpenCV's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from core.errors import InputError
from core.formats import excerpt
from core.geometry import AnyArray, FloatArray

DICTIONARIES = ("4X4_50", "4X4_100", "5X5_50", "5X5_100", "6X6_50", "6X6_100")
"""Sets of markers that a board may use: bits along a side, and how many markers there are."""
MARKER_SHARE = 0.75
"""Side of a marker, in sides of its square: the white rim is what the corners are found by."""
MIN_SQUARES, MAX_SQUARES = 4, 20
MIN_SQUARE_M, MAX_SQUARE_M = 0.005, 0.2


@dataclass(frozen=True)
class BoardSpec:
    """A ChArUco board as it was printed.

    Board frame: origin at the outer corner of the first square, x along the rows of squares, y from row to
    row, z into the board, away from who looks at it.

    Attributes:
        columns: squares in a row.
        rows: of squares.
        square_m: side of a square, as measured on the print.
        dictionary: one of `DICTIONARIES`.
    """

    columns: int = 8
    rows: int = 5
    square_m: float = 0.030
    dictionary: str = "4X4_50"

    def __post_init__(self) -> None:
        """Refuse what cannot be printed.

        Raises:
            InputError: the sentence says what to choose instead.
        """
        if self.dictionary not in DICTIONARIES:
            raise InputError(
                f"There is no dictionary '{excerpt(self.dictionary)}' of markers; take one of "
                f"{', '.join(DICTIONARIES)}."
            )
        if not (MIN_SQUARES <= self.columns <= MAX_SQUARES and MIN_SQUARES <= self.rows <= MAX_SQUARES):
            raise InputError(
                f"A board of {self.columns} x {self.rows} squares cannot be used; take {MIN_SQUARES} to "
                f"{MAX_SQUARES} each way."
            )
        if not MIN_SQUARE_M <= self.square_m <= MAX_SQUARE_M:
            raise InputError(
                f"Squares of {self.square_m * 1000:g} mm cannot be used; enter {MIN_SQUARE_M * 1000:g} to "
                f"{MAX_SQUARE_M * 1000:g} mm."
            )
        n_markers, n_known = self.columns * self.rows // 2, int(self.dictionary.split("_")[1])
        if n_markers > n_known:
            raise InputError(
                f"A board of {self.columns} x {self.rows} squares needs {n_markers} markers, and "
                f"{self.dictionary} "
                f"has {n_known}; take fewer squares or a larger dictionary."
            )

    @property
    def n_corners(self) -> int:
        """How many corners of the chessboard lie inside it."""
        return (self.columns - 1) * (self.rows - 1)

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height of the printed squares."""
        return self.columns * self.square_m, self.rows * self.square_m

    @cached_property
    def corners_m(self) -> FloatArray:
        """Inner corners (N, 3) in the board frame; their index is their number."""
        column, row = np.meshgrid(np.arange(1, self.columns), np.arange(1, self.rows))
        numbers = np.stack([column, row, np.zeros_like(row)], axis=-1).reshape(-1, 3)
        return np.asarray(numbers * self.square_m, dtype=float)

    @property
    def center_m(self) -> FloatArray:
        """Middle (3,) of the board, in its frame."""
        return np.array([*self.size_m, 0.0]) / 2

    @property
    def outline_m(self) -> FloatArray:
        """Outer corners (4, 3) in the board frame, in their order around it."""
        width, height = self.size_m
        return np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]], dtype=float)

    def cv_board(self) -> Any:
        """Return the board as OpenCV's `aruco` takes it, with lengths in metres."""
        from cv2 import aruco

        marker_m = MARKER_SHARE * self.square_m
        return aruco.CharucoBoard((self.columns, self.rows), self.square_m, marker_m, self._cv_dictionary())

    def cells(self) -> AnyArray:
        """Draw it in its smallest cells.

        Returns:
            (R, C) bool, true where it is black, and R : C as the board's height and width; a marker's bits
            and rim, and the white around it, are whole cells.
        """
        bits = int(self.dictionary[0]) + 2
        side = round(bits / MARKER_SHARE * _FINENESS)
        margin = (side - bits * _FINENESS) // 2
        board = np.indices((self.rows, self.columns)).sum(axis=0) % 2 == 0
        black = np.kron(board, np.ones((side, side), dtype=bool))
        for number, (row, column) in enumerate(np.argwhere(~board)):
            marker = self._cv_dictionary().generateImageMarker(number, bits) == 0
            at = row * side + margin, column * side + margin
            fine = np.kron(marker, np.ones((_FINENESS, _FINENESS), dtype=bool))
            black[at[0] : at[0] + len(fine), at[1] : at[1] + len(fine)] = fine
        return black

    def _cv_dictionary(self) -> Any:
        from cv2 import aruco

        return aruco.getPredefinedDictionary(getattr(aruco, f"DICT_{self.dictionary}"))


_FINENESS = 6
"""Cells along a bit: so many that a marker's rim is whole cells for 6, 7 and 8 bits alike."""
