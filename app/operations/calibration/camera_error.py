"""What the calibration of a cell's camera leaves open of where a scanned object stands."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.hand_eye import is_same
from app.operations.calibration.provenance import RESULT, latest_result
from core.calibration.rig import HAND_EYE, N_POSES
from core.files import reading
from core.geometry import FloatArray


def camera_error(cell_file: Path, T_flange_camera: FloatArray) -> tuple[float, float] | None:
    """Return how far off one view sees an object at the place of pouring.

    Args:
        cell_file: of the cell.
        T_flange_camera: (4, 4) the hand-eye pose in the file.

    Returns:
        standard deviations along an axis (m) and about one (rad), those of the fit's t-distribution; none if
        this pose was not calibrated here.

    Raises:
        SessionError: the record is damaged.
    """
    latest = latest_result(cell_file, step_names.HAND_EYE)
    if latest is None or not is_same(latest[1]["after"], T_flange_camera):
        return None
    folder, table = latest
    with reading(folder / RESULT):
        expected_m, freedom = float(table["bounds"]["expected_pouring_m"]), float(table["degrees_of_freedom"])
        covariance = np.array(table["covariance"], dtype=float)
        if covariance.shape[0] < N_POSES or freedom <= 2:
            raise ValueError("it states no errors")
        turn = covariance[HAND_EYE, HAND_EYE][:3, :3]
        return expected_m / sqrt(3), float(np.sqrt(np.trace(turn) / 3 * freedom / (freedom - 2)))
