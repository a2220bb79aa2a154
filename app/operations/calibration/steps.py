"""The steps of setting a cell up: which are done, which are stale because of another, and their figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from enum import Enum
from functools import partial
from pathlib import Path

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.cup_entry import is_cup_in_file, reach_is_for
from app.operations.calibration.devices import device_table
from app.operations.calibration.hand_eye import is_same
from app.operations.calibration.provenance import (
    BoardEntry,
    calibration_folder,
    latest_result,
    now,
    read_boards,
    write_boards,
)
from app.operations.calibration.table import is_in_file
from app.operations.calibration.touch import read_touches
from app.operations.calibration.views import are_for, are_in_file
from core.calibration.board import BoardSpec
from core.calibration.checking import MOST_RATIO
from core.calibration.drift import Drift
from core.calibration.printing import write_board_pdf
from core.calibration.touching import MOST_OFF_M
from core.files import make_folder, reading
from core.session import explained
from hardware.cell import read_cell


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
        name: of the step, as the commands have it.
        state: how far it is.
        figure: what came of it, or what is to be done; of parts joined by "; " the first says the most.
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
    ways: tuple[Callable[[Path], Step], ...] = (
        partial(_device, step=step_names.ARM), partial(_device, step=step_names.CAMERA),
        _board, _hand_eye, _check, _table, _views, _reference, _cup, _dry_run,
    )  # fmt: skip
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
            make_folder(folder)
            write_board_pdf(pdf, board, paper)
        entry = BoardEntry(board, False, now())
    write_boards(cell_file, [*entries, entry])
    return pdf


def _device(cell_file: Path, step: str) -> Step:
    latest = latest_result(cell_file, step)
    if latest is None:
        return Step(step, StepState.OPEN, "find out what it is, and whether it can be used")
    folder, table = latest
    with reading(folder):
        time, said, problem, device = (str(table["time"]), table["said"], table["problem"], table["device"])
    if device != device_table(read_cell(cell_file), step):
        return Step(step, StepState.STALE, "the file has another one than was tried", time)
    return Step(step, StepState.FAILED if problem else StepState.DONE, problem or said, time)


def _board(cell_file: Path) -> Step:
    entries = read_boards(cell_file)
    if not entries:
        return Step(step_names.BOARD, StepState.OPEN, "print one, and measure its squares")
    board = entries[-1].board
    said = f"{board.columns} x {board.rows} squares of {board.square_m * 1000:g} mm, {board.dictionary}"
    if not entries[-1].is_measured:
        return Step(
            step_names.BOARD,
            StepState.OPEN,
            f"{said}: measure the squares on the print, and enter their side",
        )
    return Step(step_names.BOARD, StepState.DONE, f"{said}, as measured", entries[-1].time)


def _hand_eye(cell_file: Path) -> Step:
    latest = latest_result(cell_file, step_names.HAND_EYE)
    if latest is None:
        return Step(step_names.HAND_EYE, StepState.OPEN, "calibrate where the camera hangs")
    folder, table = latest
    with reading(folder):
        stated, held_out = table["bounds"], table["held_out"]
        figure = (
            f"{stated['pouring_m'] * 1000:.2f} mm at the place of pouring (95 %); camera to "
            f"{stated['position_m'] * 1000:.2f} mm and {np.degrees(stated['angle_rad']):.3f} degrees; "
            f"{table['n_views']} views, unseen ones to {held_out['position_m'] * 1000:.2f} mm"
        )
        time, after, board = str(table["time"]), table["after"], table["board"]
    entries = read_boards(cell_file)
    if not is_same(after, read_cell(cell_file).camera.pose):
        return Step(
            step_names.HAND_EYE,
            StepState.STALE,
            "the file has another hand-eye pose than was calibrated",
            time,
        )
    if not entries or asdict(entries[-1].board) != board:
        return Step(step_names.HAND_EYE, StepState.STALE, "the board was entered anew since", time)
    return Step(step_names.HAND_EYE, StepState.DONE, figure, time)


def _check(cell_file: Path) -> Step:
    latest = latest_result(cell_file, step_names.CHECK)
    if latest is None:
        return Step(step_names.CHECK, StepState.OPEN, "move the board, and look at it from all sides")
    folder, table = latest
    with reading(folder):
        agreement = table["agreement"]
        figure = (
            f"{table['n_views']} views agree to {agreement['rms_m'] * 1000:.2f} mm (worst two "
            f"{agreement['worst_m'] * 1000:.2f} mm); {agreement['ratio']:.1f} times what is expected"
        )
        time, hand_eye, is_good = str(table["time"]), table["hand_eye"], agreement["ratio"] <= MOST_RATIO
    touches = read_touches(folder)
    if touches:
        off_m = max(float(np.linalg.norm(touch["off_m"])) for touch in touches)
        corners = "corner" if len(touches) == 1 else "corners"
        figure += f"; touch check: {len(touches)} {corners} within {off_m * 1000:.1f} mm"
        is_good = is_good and off_m <= MOST_OFF_M
    if not _is_by_present_camera(cell_file, hand_eye):
        return Step(
            step_names.CHECK, StepState.STALE, "the calibration that was checked is not the present one", time
        )
    return Step(step_names.CHECK, StepState.DONE if is_good else StepState.FAILED, figure, time)


def _table(cell_file: Path) -> Step:
    latest = latest_result(cell_file, step_names.TABLE)
    if latest is None:
        return Step(
            step_names.TABLE,
            StepState.OPEN,
            "lay the board on the middle of the platform, and measure where it is",
        )
    folder, table = latest
    with reading(folder):
        x, y, z = (1000 * value for value in table["center_m"])
        figure = (
            f"the platform's top is {z:.1f} mm above the base; its middle at ({x:.0f}, {y:.0f}) mm, "
            f"tilted by {np.degrees(table['tilt_rad']):.2f} degrees"
        )
        time, hand_eye, after = str(table["time"]), table["hand_eye"], table["after"]
        is_same_place = is_in_file(read_cell(cell_file).place, after)
    if not is_same_place:
        return Step(step_names.TABLE, StepState.STALE, "the file has another place than was measured", time)
    if not _is_by_present_camera(cell_file, hand_eye):
        return Step(
            step_names.TABLE,
            StepState.STALE,
            "it was measured with another calibration than the present one",
            time,
        )
    return Step(step_names.TABLE, StepState.DONE, figure, time)


def _views(cell_file: Path) -> Step:
    latest, settings = latest_result(cell_file, step_names.VIEWS), read_cell(cell_file)
    if latest is None:
        return Step(
            step_names.VIEWS,
            StepState.OPEN,
            f"choose views for this cell; the file has {len(settings.scan.views_rad)}",
        )
    folder, table = latest
    with reading(folder):
        time, figure = str(table["time"]), str(table["said"])
        is_same_set, is_same_cell = are_in_file(settings, table["after"]), are_for(table["for"], settings)
    if not is_same_set:
        return Step(step_names.VIEWS, StepState.STALE, "the file has other views than were chosen", time)
    if not is_same_cell:
        return Step(
            step_names.VIEWS,
            StepState.STALE,
            "camera, home or places are others than they were chosen for",
            time,
        )
    return Step(step_names.VIEWS, StepState.DONE, figure, time)


def _reference(cell_file: Path) -> Step:
    latest = latest_result(cell_file, step_names.REFERENCE)
    if latest is None:
        return Step(step_names.REFERENCE, StepState.OPEN, "fix the board where it can stay, and store a view")
    folder, table = latest
    with reading(folder):
        time, hand_eye, n_corners = str(table["time"]), table["hand_eye"], len(table["ids"])
    if not _is_by_present_camera(cell_file, hand_eye):
        return Step(
            step_names.REFERENCE, StepState.STALE, "the camera was calibrated anew since it was stored", time
        )
    said = f"{n_corners} corners of the board; looked at again when a scan begins"
    drifts = latest_result(cell_file, step_names.DRIFT)
    if drifts is not None:
        with reading(drifts[0]):
            shift_m, turn_rad = (np.array(drifts[1][name], dtype=float) for name in ("shift_m", "turn_rad"))
            said += f"; last time it had moved by {Drift(shift_m, turn_rad).sentence}"
    return Step(step_names.REFERENCE, StepState.DONE, said, time)


def _cup(cell_file: Path) -> Step:
    latest, settings = latest_result(cell_file, step_names.CUP), read_cell(cell_file)
    if latest is None:
        return Step(step_names.CUP, StepState.OPEN, "enter where the cup stands, and how large it is")
    folder, table = latest
    with reading(folder):
        time, said = str(table["time"]), str(table["said"])
        is_same_place = table["for"] == reach_is_for(settings)
        is_same_cup = is_cup_in_file(settings, table["after"])
    if not is_same_cup:
        return Step(
            step_names.CUP, StepState.STALE, "the file has another cup or station than was entered", time
        )
    if not is_same_place:
        return Step(step_names.CUP, StepState.STALE, "the cell has changed since its reach was judged", time)
    return Step(step_names.CUP, StepState.DONE, said, time)


def _dry_run(cell_file: Path) -> Step:
    latest, settings = latest_result(cell_file, step_names.DRY_RUN), read_cell(cell_file)
    if latest is None:
        return Step(step_names.DRY_RUN, StepState.OPEN, "let the arm make a pour with an empty cup")
    folder, table = latest
    with reading(folder):
        time, said, is_same = str(table["time"]), str(table["said"]), table["for"] == reach_is_for(settings)
    if not is_same:
        return Step(
            step_names.DRY_RUN, StepState.STALE, "the cell has changed since the arm went through it", time
        )
    return Step(step_names.DRY_RUN, StepState.DONE, said, time)


def _is_by_present_camera(cell_file: Path, hand_eye: str) -> bool:
    """Whether a run of the hand-eye calibration is the one that counts."""
    now_valid = latest_result(cell_file, step_names.HAND_EYE)
    if now_valid is None or now_valid[0].name != hand_eye:
        return False
    return _hand_eye(cell_file).state is StepState.DONE
