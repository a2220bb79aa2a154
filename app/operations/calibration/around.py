"""Seeing where the board lies, with a calibrated camera that looks at it from all sides."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.capture import Capture, CaptureObserver, capturing, find_board
from app.operations.calibration.hand_eye import entered_board, is_same
from app.operations.calibration.provenance import RESULT, latest_result, read_looks
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.checking import FEWEST_VIEWS
from core.calibration.hand_eye import HandEyeFit
from core.calibration.noise import Noise, pose_errors
from core.calibration.proposing import Proposal, ProposalTask, in_short_order, propose_poses
from core.calibration.rig import Rig, all_derivatives
from core.calibration.views import BoardView
from core.errors import InputError, StageError
from core.files import reading
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.progress import Reporter
from core.scan.model import Intrinsics
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell import Cell, read_cell
from hardware.cell.settings import CellSettings

N_VIEWS = 6
_MARGIN_PX = 25.0


@dataclass(frozen=True)
class CalibratedCell:
    """A cell whose camera was calibrated.

    Attributes:
        settings: what its file says.
        board: that was entered.
        folder: of the calibration that is in the file.
        table: its result.
    """

    settings: CellSettings
    board: BoardSpec
    folder: Path
    table: dict[str, Any]

    def fit(self, intrinsics: Intrinsics) -> HandEyeFit:
        """Return the calibration's fit, for a camera with these intrinsics.

        Raises:
            SessionError: the record is damaged.
        """
        _, looks = read_looks(self.folder)
        views = [look.view for look in looks if look.view is not None and look.is_used]
        table = self.table
        with reading(self.folder / RESULT):
            rig = Rig(table["after"], table["T_base_board"], intrinsics)
            return HandEyeFit(
                rig=rig,
                covariance=np.array(table["covariance"]),
                degrees_of_freedom=float(table["degrees_of_freedom"]),
                noise=Noise(**table["noise"]),
                poses=pose_errors(all_derivatives(rig, self.board, views)),
                weights=np.array(table["weights"]),
                rms_px=float(table["rms_px"]),
            )


def calibrated_cell(cell_file: Path) -> CalibratedCell:
    """Return a cell whose board was measured, and whose file has the hand-eye pose that was calibrated.

    Raises:
        InputError: the board was not measured, or the hand-eye pose in the file is another one.
    """
    settings, board = read_cell(cell_file), entered_board(cell_file)
    latest = latest_result(cell_file, step_names.HAND_EYE)
    if latest is None or not is_same(latest[1]["after"], settings.camera.pose):
        raise InputError(
            f"The hand-eye pose in {cell_file} is not one that was calibrated here; calibrate first."
        )
    return CalibratedCell(settings, board, *latest)


@contextmanager
def looking(
    calibrated: CalibratedCell,
    cell_file: Path,
    step: str,
    reporter: Reporter,
    operator: ScanOperator | None,
    laid: Callable[[], None],
    observer: CaptureObserver,
    n_wanted: int,
    facts: dict[str, Any] | None = None,
) -> Iterator[Capture]:
    """Ask for the board where it is wanted, and connect a calibrated cell that shall look at it.

    Args:
        calibrated: the cell.
        cell_file: of it.
        step: that looks.
        reporter: may cancel.
        operator: confirms what a real arm does.
        laid: called when a person has to lay the board there; raises `Cancelled` if that is not done.
        observer: of whoever follows it.
        n_wanted: how many looks.
        facts: kept with the looks, beside the board and the calibration.

    Raises:
        PoursightError: see `capturing`.
    """
    known = {"board": asdict(calibrated.board), "hand_eye": calibrated.folder.name} | (facts or {})
    if not calibrated.settings.has_simulated_object:
        laid()
    with capturing(
        cell_file, calibrated.settings, calibrated.board, step, known, reporter, operator, observer, n_wanted
    ) as capture:
        yield capture


def look_around(capture: Capture) -> tuple[BoardView, ...]:
    """Look at the board, wherever it lies, from all sides.

    Raises:
        StageError: it is not in sight, or too few views could be used.
    """
    find_board(capture)
    here = np.array(capture.cell.robot.state().joints_rad)
    capture.go_and_look(in_short_order(poses_around(capture, N_VIEWS, capture.cell.scene), here))
    views = capture.collection.views
    if len(views) < FEWEST_VIEWS:
        raise StageError(
            f"Only {len(views)} views of the board could be used; see that the arm can go around it, and "
            "look again."
        )
    return views


def poses_around(capture: Capture, most: int, scene: MotionScene) -> tuple[Proposal, ...]:
    """Return up to `most` poses, clear of a scene, that see the board well where it was found; best first."""
    settings, collection = capture.cell.settings, capture.collection
    first = next(look.view for look in collection.looks if look.view is not None)
    T_base_board = first.T_base_flange @ settings.camera.pose @ first.T_camera_board
    rig = Rig(settings.camera.pose, T_base_board, collection.intrinsics)
    task = ProposalTask(
        rig, collection.board, collection.image_size_px, collection.home_rad, _MARGIN_PX,
        collection.min_range_m,
    )  # fmt: skip
    return propose_poses(scene, task, most)


def lay_simulated_board(cell: Cell, middle_m: FloatArray, yaw_rad: float) -> None:
    """Lay the board of a simulated cell elsewhere, its middle at a point (3,)."""
    camera = cell.camera
    assert isinstance(camera, SimulatedBoardCamera), "a simulated cell that looks at its board"
    camera.T_base_board = camera.lying(middle_m, yaw_rad)
