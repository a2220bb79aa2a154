"""A cell that looks at its calibration board instead of an object."""

from __future__ import annotations

from dataclasses import replace

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
        return facing_board(open_cell(settings), board)
    return facing_board(open_cell(settings, _empty_world(settings)), board)


def facing_board(cell: Cell, board: BoardSpec) -> Cell:
    """Return a cell, connected or not, as it is when nothing but its board lies there; see above."""
    settings = cell.settings
    scene = board_scene(settings)
    if not settings.has_simulated_object:
        return replace(cell, scene=scene)
    simulation = settings.simulation
    set_up = simulated_set_up(settings)
    camera = SimulatedBoardCamera(
        _empty_world(settings),
        cell.robot,
        ARMS[settings.robot.model],
        set_up,
        with_square(board, set_up.square_m),
        None if simulation.is_perfect else simulation.noise,
    )
    return replace(cell, scene=scene, camera=camera)


def _empty_world(settings: CellSettings) -> World:
    place = settings.place
    return World(None, np.array([*place.platform_center_m[:2], place.table_height_m]))


def simulated_set_up(settings: CellSettings) -> SetUp:
    """Return what a simulated cell really is; where its file says nothing of it, it is as believed."""
    if settings.simulation.set_up is not None:
        return settings.simulation.set_up
    x, y, z = settings.place.platform_center_m.tolist()
    return SetUp(T_flange_camera=settings.camera.T_flange_camera, board_middle_m=(x, y, z + 0.004))
