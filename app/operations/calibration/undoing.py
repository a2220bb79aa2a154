"""Taking back what a step of a cell's set-up did last; what was recorded stays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.operations.calibration import step_names
from app.operations.calibration.cell_file import write_cup, write_former_hand_eye, write_views
from app.operations.calibration.cup_entry import is_cup_in_file
from app.operations.calibration.hand_eye import is_same
from app.operations.calibration.provenance import RESULT, latest_result, read_boards, withdraw, write_boards
from app.operations.calibration.table import is_in_file, write_former_place
from app.operations.calibration.views import are_in_file
from core.errors import InputError
from core.files import reading
from hardware.cell import read_cell
from hardware.cell.settings import CellSettings


@dataclass(frozen=True)
class _Writing:
    """What a step wrote into the cell's file.

    Attributes:
        is_there: whether the file still holds what the step's record calls `after`.
        write: puts back what the record, a table, says was there before.
    """

    is_there: Callable[[CellSettings, Any], bool]
    write: Callable[[Path, dict[str, Any]], None]


def _put_back(write: Callable[[Path, Any], None]) -> Callable[[Path, dict[str, Any]], None]:
    return lambda path, table: write(path, table["before"])


_WRITINGS = {
    step_names.HAND_EYE: _Writing(
        lambda settings, after: is_same(after, settings.camera.pose),
        lambda path, table: write_former_hand_eye(path, table["before"], dict(table.get("arm_before", {}))),
    ),
    step_names.TABLE: _Writing(
        lambda settings, after: is_in_file(settings.place, after), _put_back(write_former_place)
    ),
    step_names.VIEWS: _Writing(are_in_file, _put_back(write_views)),
    step_names.CUP: _Writing(is_cup_in_file, _put_back(write_cup)),
}


def undo(cell_file: Path, step: str) -> None:
    """Take back what a step did last.

    Raises:
        InputError: it was never done, or the cell's file was changed since.
        SessionError: the disk refuses.
    """
    if step == step_names.BOARD:
        _forget_board(cell_file)
        return
    latest = latest_result(cell_file, step)
    if latest is None:
        raise _none_to_undo(cell_file, step)
    folder, table = latest
    if step in _WRITINGS:
        writing = _WRITINGS[step]
        with reading(folder / RESULT):
            time = table["time"]
            is_there = writing.is_there(read_cell(cell_file), table["after"])
        if not is_there:
            raise InputError(
                f"The values that the step '{step}' wrote into {cell_file} were changed since {time}; "
                "correct them there."
            )
        with reading(folder / RESULT):
            writing.write(cell_file, table)
    withdraw(folder)


def _forget_board(cell_file: Path) -> None:
    entries = read_boards(cell_file)
    if not entries:
        raise _none_to_undo(cell_file, step_names.BOARD)
    write_boards(cell_file, entries[:-1])


def _none_to_undo(cell_file: Path, step: str) -> InputError:
    return InputError(f"The step '{step}' of {cell_file} was not done yet, so there is nothing to undo.")
