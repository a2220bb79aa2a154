"""A cell: one camera, one robot, one gripper, and everything that was measured or decided about them."""

from hardware.cell.arm import Arm, open_arm
from hardware.cell.cell import Cell, open_cell
from hardware.cell.cell_file import SIMULATED_CELL, read_cell
from hardware.cell.settings import CellSettings

__all__ = ["SIMULATED_CELL", "Arm", "Cell", "CellSettings", "open_arm", "open_cell", "read_cell"]
