"""What the Cell page shows of a cell and its records, read in the background. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from app.gui.pages.cell_model import ShownCell, load_shown_cell
from app.gui.views.scene import Frustum
from app.operations.calibration import step_names
from app.operations.calibration.cell_file import known_cells
from app.operations.calibration.provenance import (
    VIEWS,
    BoardEntry,
    interrupted_run,
    latest_result,
    read_boards,
    read_looks,
    runs,
)
from app.operations.calibration.steps import Step, StepState, steps
from app.operations.calibration.touch import read_touches, usual_tip_m
from core.motion.kinematics import flange_pose
from core.scan.view_files import read_color

if TYPE_CHECKING:
    import numpy.typing as npt

    from core.calibration.collecting import Look
    from core.geometry import FloatArray
    from hardware.cell import CellSettings

_WITH_LOOKS = (step_names.HAND_EYE, step_names.CHECK, step_names.TABLE, step_names.REFERENCE)


@dataclass(frozen=True, eq=False)
class CellKey:
    """What is to be read, at every refresh: records are added without another cell.

    Attributes:
        path: of the cell's file; none for the one that the program ships.
        settings: what it says.
    """

    path: Path | None
    settings: CellSettings


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a step looked at.

    Attributes:
        frusta: from where.
        T_base_board: (4, 4) where the board was seen last; none if it was not.
        color: (H, W, 3) the last image; none if there is none.
    """

    frusta: tuple[Frustum, ...] = ()
    T_base_board: FloatArray | None = None
    color: npt.NDArray[np.uint8] | None = None


@dataclass(frozen=True, eq=False)
class CellContents:
    """What is there.

    Attributes:
        path: of the cell's file; none for the one that the program ships.
        shown: arm and furniture.
        known: all cells' files.
        steps: of this cell, in their order; none for the cell that the program ships.
        evidence: of those steps that have some, by name.
        board: that was entered last; none if none was.
        is_interrupted: whether a calibration was begun and not finished.
        tip_m: (3,) in the flange frame, with which a corner of the board was touched last, or will be.
        is_checked: whether it is known where the board lies: a corner may be touched.
    """

    path: Path | None
    shown: ShownCell
    known: tuple[Path, ...]
    steps: tuple[Step, ...] = ()
    evidence: dict[str, Evidence] = field(default_factory=dict)
    board: BoardEntry | None = None
    is_interrupted: bool = False
    tip_m: tuple[float, ...] = (0.0, 0.0, 0.0)
    is_checked: bool = False


def load_cell(key: CellKey) -> CellContents:
    """Read everything.

    Raises:
        PoursightError: the file or a record is damaged.
    """
    shown, known = load_shown_cell(key.settings), known_cells()
    if key.path is None:
        return CellContents(None, shown, known)
    evidence = {step: _evidence(key.path, step, key.settings) for step in _WITH_LOOKS}
    evidence[step_names.VIEWS] = Evidence(_scan_views(key.settings))
    boards = read_boards(key.path)
    is_interrupted = interrupted_run(key.path, step_names.HAND_EYE) is not None
    board = boards[-1] if boards else None
    cell_steps = steps(key.path)
    states = {step.name: step.state for step in cell_steps}
    return CellContents(
        key.path,
        shown,
        known,
        cell_steps,
        evidence,
        board,
        is_interrupted,
        _tip_m(key.path, key.settings),
        states[step_names.CHECK] in (StepState.DONE, StepState.FAILED),
    )


def _tip_m(path: Path, settings: CellSettings) -> tuple[float, ...]:
    checked = latest_result(path, step_names.CHECK)
    touches = [] if checked is None else read_touches(checked[0])
    return tuple(usual_tip_m(settings, touches).tolist())


def _evidence(path: Path, step: str, settings: CellSettings) -> Evidence:
    folders = [folder for folder in runs(path, step) if (folder / VIEWS).is_file()]
    if not folders:
        return Evidence()
    _, looks = read_looks(folders[-1])
    T_flange_camera = settings.camera.pose
    frusta = tuple(
        Frustum(f"view {k}", _flange(look, settings) @ T_flange_camera, _state(look))
        for k, look in enumerate(looks, 1)
    )
    seen = [look.view for look in looks if look.view is not None]
    board = seen[-1].T_base_flange @ T_flange_camera @ seen[-1].T_camera_board if seen else None
    pictures = sorted(folders[-1].glob("view-*.png"))
    return Evidence(frusta, board, read_color(pictures[-1]) if pictures else None)


def _flange(look: Look, settings: CellSettings) -> FloatArray:
    if look.view is not None:
        return look.view.T_base_flange
    return flange_pose(settings.robot.arm, look.joints_rad)


def _state(look: Look) -> Literal["taken", "poor", "failed"]:
    if look.view is None:
        return "failed"
    return "taken" if look.is_used else "poor"


def _scan_views(settings: CellSettings) -> tuple[Frustum, ...]:
    poses = flange_pose(settings.robot.arm, np.array(settings.scan.views_rad)) @ settings.camera.pose
    return tuple(Frustum(f"view {k}", pose) for k, pose in enumerate(poses, 1))
