"""The steps of setting a cell up: which are done, which are stale because of another, and their figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from app.operations.calibration.hand_eye import is_same
from app.operations.calibration.provenance import (
    CHECK,
    HAND_EYE,
    BoardEntry,
    calibration_folder,
    latest_result,
    now,
    read_boards,
    write_boards,
)
from core.calibration.board import BoardSpec
from core.calibration.checking import MOST_RATIO
from core.calibration.printing import write_board_pdf
from core.errors import InputError
from core.files import reading
from core.session import explained
from hardware.cell import read_cell

BOARD = "board"


class StepState(Enum):
    """How far a step is."""

    OPEN = "open"
    DONE = "done"
    STALE = "stale"
    FAILED = "failed"


@dataclass(frozen=True)
class Step:
    """One step of setting a cell up.

    Attributes:
        name: board, hand-eye or check.
        state: how far it is.
        figure: what came of it, or what is to be done.
        time: when it was done; empty if it was not.
    """

    name: str
    state: StepState
    figure: str
    time: str = ""


def steps(cell_file: Path) -> tuple[Step, ...]:
    """Return the steps of a cell in their order, as its file and the records beside it have them.

    Raises:
        PoursightError: the file or a record is damaged.
    """
    read_cell(cell_file)
    ways: tuple[Callable[[Path], Step], ...] = (_board, _hand_eye, _check)
    return tuple(way(cell_file) for way in ways)


def enter_board(cell_file: Path, board: BoardSpec, paper: str, measured_m: float | None) -> Path:
    """Print a board to a PDF beside the cell's file, or enter what was measured on the print.

    Args:
        cell_file: of the cell.
        board: as it shall be printed; with a measured size, as it was printed.
        paper: that it is printed on.
        measured_m: side of a square on the print; none if it is only printed now.

    Returns:
        the PDF.

    Raises:
        InputError: the board cannot be, or does not fit the paper.
        SessionError: the disk refuses.
    """
    folder = calibration_folder(cell_file)
    pdf = folder / f"board-{paper}.pdf"
    entries = read_boards(cell_file)
    if measured_m is not None:
        entry = BoardEntry(replace(board, square_m=measured_m), True, now())
    else:
        with explained(cell_file.parent):
            folder.mkdir(parents=True, exist_ok=True)
            write_board_pdf(pdf, board, paper)
        entry = BoardEntry(board, False, now())
    write_boards(cell_file, [*entries, entry])
    return pdf


def undo_board(cell_file: Path) -> BoardEntry | None:
    """Forget the board that was entered last; return the one before it.

    Raises:
        InputError: there is none.
    """
    entries = read_boards(cell_file)
    if not entries:
        raise InputError(f"No board of {cell_file} can be undone; there is none.")
    write_boards(cell_file, entries[:-1])
    return entries[-2] if len(entries) > 1 else None


def _board(cell_file: Path) -> Step:
    entries = read_boards(cell_file)
    if not entries:
        return Step(BOARD, StepState.OPEN, "print one, and measure its squares")
    board = entries[-1].board
    said = f"{board.columns} x {board.rows} squares of {board.square_m * 1000:g} mm, {board.dictionary}"
    if not entries[-1].is_measured:
        return Step(BOARD, StepState.OPEN, f"{said}: measure the squares on the print, and enter their side")
    return Step(BOARD, StepState.DONE, f"{said}, as measured", entries[-1].time)


def _hand_eye(cell_file: Path) -> Step:
    latest = latest_result(cell_file, HAND_EYE)
    if latest is None:
        return Step(HAND_EYE, StepState.OPEN, "calibrate where the camera hangs")
    folder, table = latest
    with reading(folder):
        stated, held_out = table["bounds"], table["held_out"]
        figure = (
            f"{stated['pouring_m'] * 1000:.2f} mm at the place of pouring (95 %), camera to "
            f"{stated['position_m'] * 1000:.2f} mm and {np.degrees(stated['angle_rad']):.3f} degrees; "
            f"{table['n_views']} views, unseen ones to {held_out['position_m'] * 1000:.2f} mm"
        )
        time, after, board = str(table["time"]), table["after"], table["board"]
    entries = read_boards(cell_file)
    if not is_same(after, read_cell(cell_file).camera.pose):
        return Step(HAND_EYE, StepState.STALE, "the file has another hand-eye pose than was calibrated", time)
    if not entries or asdict(entries[-1].board) != board:
        return Step(HAND_EYE, StepState.STALE, "the board was entered anew since", time)
    return Step(HAND_EYE, StepState.DONE, figure, time)


def _check(cell_file: Path) -> Step:
    latest = latest_result(cell_file, CHECK)
    if latest is None:
        return Step(CHECK, StepState.OPEN, "move the board, and look at it from all sides")
    folder, table = latest
    with reading(folder):
        agreement = table["agreement"]
        figure = (
            f"{table['n_views']} views agree to {agreement['rms_m'] * 1000:.2f} mm (worst two "
            f"{agreement['worst_m'] * 1000:.2f} mm), {agreement['ratio']:.1f} times what is expected"
        )
        time, hand_eye, is_good = str(table["time"]), table["hand_eye"], agreement["ratio"] <= MOST_RATIO
    now_valid = latest_result(cell_file, HAND_EYE)
    if now_valid is None or now_valid[0].name != hand_eye or _hand_eye(cell_file).state is not StepState.DONE:
        return Step(CHECK, StepState.STALE, "the calibration that was checked is not the present one", time)
    return Step(CHECK, StepState.DONE if is_good else StepState.FAILED, figure, time)
