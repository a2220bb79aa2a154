"""The crop box of a cell, entered or dragged; measuring the platform moves it along."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.operations.calibration.cell_file import write_place
from app.operations.calibration.table import PLACE_DIGITS
from core.errors import InputError
from hardware.cell import read_cell
from hardware.cell.settings import SMALLEST_EDGE_M


def enter_crop_box(cell_file: Path, low_m: npt.ArrayLike, high_m: npt.ArrayLike) -> None:
    """Put another crop box into a cell's file.

    Args:
        cell_file: of the cell.
        low_m: (3,) lower corner, in the arm's base frame.
        high_m: (3,) upper corner.

    Raises:
        InputError: no object could stand in it; the file stays as it was.
        SessionError: the file cannot be written; it stays as it was.
    """
    low, high = (np.asarray(corner, dtype=float).round(PLACE_DIGITS) for corner in (low_m, high_m))
    middle_m = read_cell(cell_file).place.platform_center_m
    if not (high - low >= SMALLEST_EDGE_M).all():
        raise InputError(
            f"The crop box is empty; its upper corner must lie at least {1000 * SMALLEST_EDGE_M:.0f} mm "
            "beyond its lower one along x, y and z."
        )
    if not ((low < middle_m) & (middle_m < high)).all():
        x, y, z = 1000 * middle_m
        raise InputError(
            f"The middle of the platform's top, ({x:.0f}, {y:.0f}, {z:.0f}) mm, is not inside the crop box, "
            "so no object there would be scanned; let it reach from below that point to above it."
        )
    write_place(cell_file, {"crop_min_m": low.tolist(), "crop_max_m": high.tolist()})
