"""A cell: one camera, one robot, one gripper, and everything that was measured or decided about them."""

from hardware.cell.cell import Arm, Cell, open_arm, open_cell
from hardware.cell.reading import SIMULATED_CELL, read_cell
from hardware.cell.settings import CellSettings

__all__ = ["SIMULATED_CELL", "Arm", "Cell", "CellSettings", "open_arm", "open_cell", "read_cell"]
