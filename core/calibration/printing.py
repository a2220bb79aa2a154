"""The board on paper, to scale: a page in PDF with a bar to check the print by."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from core.calibration.board import BoardSpec
from core.errors import InputError
from core.geometry import AnyArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.path import Path as Outline

PAPERS_MM = {"a4": (297.0, 210.0), "letter": (279.4, 215.9)}
"""Width and height, lying."""
_INCH_MM = 25.4
_RULER_MM = 100.0
_MARGIN_MM = 10.0
"""What printers leave white, and the quiet rim that the markers at the edge need."""
_FOOT_MM = 22.0


def write_board_pdf(path: Path, board: BoardSpec, paper: str) -> None:
    """Write the page; to be printed at 100 %, without fitting it to the paper.

    Args:
        path: where.
        board: what to print.
        paper: one of `PAPERS_MM`.

    Raises:
        InputError: there is no such paper, or the board is too large for it.
        OSError: the file cannot be written.
    """
    draw_page(board, paper).savefig(path, format="pdf", metadata={"CreationDate": None})


def draw_page(board: BoardSpec, paper: str) -> Figure:
    """Draw the page to scale: the board, a bar of 100 mm, and what to do with it.

    Raises:
        InputError: as `write_board_pdf`.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import PathPatch

    width_mm, height_mm = _page(board, paper)
    board_mm = np.array(board.size_m) * 1000
    left_mm, bottom_mm = (width_mm - board_mm[0]) / 2, height_mm - _MARGIN_MM - board_mm[1]
    figure = Figure(figsize=(width_mm / _INCH_MM, height_mm / _INCH_MM))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width_mm), ylim=(0, height_mm))
    axes.set_axis_off()
    black = _black(board.cells(), np.array([left_mm, bottom_mm]), board_mm)
    axes.add_patch(PathPatch(black, facecolor="black", linewidth=0))
    _draw_ruler(axes, left_mm)
    text = (
        f"Poursight board: {board.columns} x {board.rows} squares of {board.square_m * 1000:g} mm, "
        f"{board.dictionary}. Print at 100 %; this bar must measure {_RULER_MM:.0f} mm.\n"
        "Glue the sheet flat onto something stiff, measure a whole row of squares, and enter the side of one."
    )
    axes.text(left_mm + _RULER_MM + 6, 8, text, fontsize=6.5, va="bottom", linespacing=1.5)
    return figure


def _page(board: BoardSpec, paper: str) -> tuple[float, float]:
    if paper not in PAPERS_MM:
        raise InputError(f"There is no paper '{paper}' here; take one of {', '.join(PAPERS_MM)}.")
    width_mm, height_mm = PAPERS_MM[paper]
    space_mm = width_mm - 2 * _MARGIN_MM, height_mm - _MARGIN_MM - _FOOT_MM
    board_mm = board.size_m[0] * 1000, board.size_m[1] * 1000
    if board_mm[0] > space_mm[0] + 1e-6 or board_mm[1] > space_mm[1] + 1e-6:
        raise InputError(
            f"A board of {board_mm[0]:.0f} x {board_mm[1]:.0f} mm does not fit on {paper.upper()}, "
            "which has space "
            f"for {space_mm[0]:.0f} x {space_mm[1]:.0f} mm; take fewer or smaller squares."
        )
    return width_mm, height_mm


def _black(cells: AnyArray, origin_mm: FloatArray, size_mm: FloatArray) -> Outline:
    """All that is black, as one outline: separate rectangles would show hair lines between them."""
    from matplotlib.path import Path as Outline

    pitch = size_mm / np.array(cells.shape[::-1])
    runs = []
    for row, line in enumerate(cells):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], line.astype(int), [0]])))
        runs += [(start, stop, row) for start, stop in edges.reshape(-1, 2)]
    whole = _joined(runs)
    corners = np.array([[(a, r), (b, r), (b, s), (a, s), (a, r)] for a, b, r, s in whole], dtype=float)
    corners[..., 1] = len(cells) - corners[..., 1]
    codes = [Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY] * len(whole)
    return Outline(origin_mm + corners.reshape(-1, 2) * pitch, codes)


def _joined(runs: list[tuple[int, int, int]]) -> list[tuple[int, int, int, int]]:
    """Join runs (start, stop, row) that lie under each other to rectangles (start, stop, first, past)."""
    open_: dict[tuple[int, int], int] = {}
    last: dict[tuple[int, int], int] = {}
    done = []
    for start, stop, row in runs:
        key = (start, stop)
        if last.get(key) != row - 1:
            if key in open_:
                done.append((*key, open_[key], last[key] + 1))
            open_[key] = row
        last[key] = row
    return done + [(*key, first, last[key] + 1) for key, first in open_.items()]


def _draw_ruler(axes: object, left_mm: float) -> None:
    from matplotlib.axes import Axes

    assert isinstance(axes, Axes)
    axes.plot([left_mm, left_mm + _RULER_MM], [8, 8], color="black", linewidth=0.6, solid_capstyle="butt")
    for k in range(11):
        x = left_mm + k * _RULER_MM / 10
        axes.plot([x, x], [8, 12 if k % 5 == 0 else 10.5], color="black", linewidth=0.4)
        if k % 5 == 0:
            axes.text(x, 13, f"{k * 10}", fontsize=6, ha="center", va="bottom")
