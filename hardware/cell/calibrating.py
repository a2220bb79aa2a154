"""A cell that looks at its calibration board instead of an object."""

from __future__ import annotations

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.detection import with_square
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell.cell import Cell, open_cell
from hardware.cell.scene import board_scene
from hardware.cell.settings import ARMS, CellSettings
from hardware.simulation.set_up import SetUp
from hardware.simulation.world import World


def open_calibration_cell(settings: CellSettings, board: BoardSpec) -> Cell:
    """Build a cell's devices; a simulated camera sees the board where the set-up has it.

    Args:
        settings: what its file says.
        board: as it was entered; in simulation its squares are as large as the set-up has them.

    Raises:
        InputError: a device is of an unknown kind.
    """
    if not settings.has_simulated_object:
        cell = open_cell(settings)
        cell.scene = board_scene(settings)
        return cell
    place, simulation = settings.place, settings.simulation
    world = World(None, np.array([*place.platform_center_m[:2], place.table_height_m]))
    cell = open_cell(settings, world)
    cell.scene = board_scene(settings)
    set_up = simulation.set_up or _as_believed(settings)
    noise = None if simulation.is_perfect else simulation.noise
    printed = with_square(board, set_up.square_m)
    cell.camera = SimulatedBoardCamera(world, cell.robot, ARMS[settings.robot.model], set_up, printed, noise)
    return cell


def _as_believed(settings: CellSettings) -> SetUp:
    """The set-up of a simulated cell whose file says nothing of it: the camera hangs where it should."""
    x, y, z = settings.place.platform_center_m.tolist()
    return SetUp(T_flange_camera=settings.camera.T_flange_camera, board_middle_m=(x, y, z + 0.004))
