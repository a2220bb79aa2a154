"""Measuring where platform and table are: the board lies on the platform, and is seen from all sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.around import (
    N_VIEWS,
    calibrated_cell,
    lay_simulated_board,
    look_around,
    looking,
)
from app.operations.calibration.capture import NOBODY, CaptureObserver
from app.operations.calibration.cell_file import write_place
from app.operations.calibration.provenance import RESULT, now, versions
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.checking import MOST_RATIO, locate_board
from core.errors import StageError
from core.files import write_json
from core.geometry import FloatArray, transform_points
from core.progress import Reporter
from core.session import explained
from hardware.cell import Cell, read_cell
from hardware.cell.settings import CellSettings, PlaceSettings

USUAL_THICKNESS_M = 0.004
MOST_TILT_RAD = np.radians(1.5)
"""On a platform of 0.4 m that is 10 mm from edge to edge, and the object's ground is taken for horizontal."""
PLACE_DIGITS = 4
"""Of a length in metres, as it is written into the cell's file."""
_HEIGHTS = ("table_height_m", "platform_height_m")
_CUP = "cup_station_m"
_CROP = ("crop_min_m", "crop_max_m")
_CORNERS = ("platform_min_m", "platform_max_m", *_CROP)


@dataclass(frozen=True)
class Table:
    """Where the platform was found.

    Attributes:
        folder: with its views and its result.
        n_views: that saw the board.
        center_m: (3,) middle of the platform's top.
        tilt_rad: of its plane against the base's x-y plane.
        moved_m: (3,) how far that is from where the file had it.
    """

    folder: Path
    n_views: int
    center_m: FloatArray
    tilt_rad: float
    moved_m: FloatArray


def measure_table(
    cell_file: Path,
    reporter: Reporter,
    operator: ScanOperator | None,
    laid: Callable[[], None],
    thickness_m: float = USUAL_THICKNESS_M,
    observer: CaptureObserver = NOBODY,
) -> Table:
    """Measure the platform by the board on its middle; table, crop box and cup station follow in the file.

    Args:
        cell_file: of the cell.
        reporter: may cancel.
        operator: confirms what a real arm does.
        laid: called when a person has to lay the board there; raises `Cancelled` if that is not done.
        thickness_m: of the board with what it is glued to.
        observer: of whoever follows it.

    Raises:
        PoursightError: the sentence says what is in the way; the file stays as it was.
    """
    calibrated = calibrated_cell(cell_file)
    settings, board = calibrated.settings, calibrated.board
    with looking(
        calibrated, cell_file, step_names.TABLE, reporter, operator, laid, observer, N_VIEWS,
        {"thickness_m": thickness_m},
    ) as capture:  # fmt: skip
        if settings.has_simulated_object:
            _lay_on_platform(capture.cell, thickness_m)
        views = look_around(capture)
    fit = calibrated.fit(capture.collection.intrinsics)
    T_base_board, ratio = locate_board(fit, views, board)
    _refuse_poor(ratio, _tilt_rad(T_base_board))
    found = _found(capture.folder, len(views), settings, board, T_base_board, thickness_m)
    before, after = _places(settings.place, found.moved_m)
    result = {
        "time": now(),
        "n_views": found.n_views,
        "T_base_board": T_base_board.tolist(),
        "center_m": found.center_m.tolist(),
        "tilt_rad": found.tilt_rad,
        "moved_m": found.moved_m.tolist(),
        "ratio": ratio,
        "before": before,
        "after": after,
    }
    with explained(found.folder):
        write_json(found.folder / RESULT, result | capture.facts | {"versions": versions()})
    write_place(cell_file, after)
    return found


def is_in_file(place: PlaceSettings, wanted: dict[str, Any]) -> bool:
    """Whether a cell's file holds these places; cup station and crop box are entered by themselves."""
    held = place.model_dump(mode="json")
    return all(
        np.allclose(held[name], value, atol=10.0**-PLACE_DIGITS / 2)
        for name, value in wanted.items()
        if name not in (_CUP, *_CROP)
    )


def write_former_place(path: Path, before: dict[str, Any]) -> None:
    """Put back where things were before they were measured; what was entered since moves along.

    That is the crop box, and of the cup's station its height.

    Raises:
        PoursightError: see `write_place`.
    """
    place = read_cell(path).place
    x, y, _ = place.cup_station_m
    back_m = np.array([*before["platform_min_m"], before["platform_height_m"]])
    back_m -= [*place.platform_min_m, place.platform_height_m]
    crop = {name: (getattr(place, name) + back_m).round(PLACE_DIGITS).tolist() for name in _CROP}
    write_place(path, before | crop | {_CUP: [x, y, before[_CUP][2]]})


def _lay_on_platform(cell: Cell, thickness_m: float) -> None:
    """A simulated platform really is as high as the set-up's board was laid on it."""
    settings = cell.settings
    middle_m = settings.place.platform_center_m
    set_up = settings.simulation.set_up
    if set_up is None:
        middle_m[2] += thickness_m
    else:
        middle_m[2] = set_up.board_middle_m[2] - USUAL_THICKNESS_M + thickness_m
    lay_simulated_board(cell, middle_m, 0.0)


def _refuse_poor(ratio: float, tilt_rad: float) -> None:
    if ratio > MOST_RATIO:
        raise StageError(
            f"The views disagree about where the board lies, {ratio:.1f} times as much as they should; see "
            "that it lies still and the camera is fixed, and measure again."
        )
    if tilt_rad > MOST_TILT_RAD:
        raise StageError(
            f"The board is tilted by {np.degrees(tilt_rad):.1f} degrees against the arm's base, and "
            f"{np.degrees(MOST_TILT_RAD):.1f} are allowed; level the platform, lay the board flat on it, and "
            "measure again."
        )


def _found(
    folder: Path,
    n_views: int,
    settings: CellSettings,
    board: BoardSpec,
    T_base_board: FloatArray,
    thickness_m: float,
) -> Table:
    center_m = transform_points(T_base_board, board.center_m)
    center_m[2] -= thickness_m
    moved_m = (center_m - settings.place.platform_center_m).round(PLACE_DIGITS)
    return Table(folder, n_views, center_m, _tilt_rad(T_base_board), moved_m)


def _tilt_rad(T_base_board: FloatArray) -> float:
    return float(np.arccos(min(abs(T_base_board[2, 2]), 1.0)))


def _places(place: PlaceSettings, moved_m: FloatArray) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the file has, and what it is to have: platform, crop box and table move, the cup's foot rises."""
    names = (*_HEIGHTS, *_CORNERS, _CUP)
    before = place.model_dump(mode="json", include=set(names))
    after: dict[str, Any] = {}
    for name in names:
        if name in _HEIGHTS:
            shift = moved_m[2]
        elif name == _CUP:
            shift = np.array([0.0, 0.0, moved_m[2]])
        else:
            shift = moved_m[: len(before[name])]
        after[name] = (np.array(before[name]) + shift).round(PLACE_DIGITS).tolist()
    return before, after
