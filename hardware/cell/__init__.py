"""A cell: one camera, one robot, one gripper, and everything that was measured or decided about them."""

from hardware.cell.cell import Arm, Cell, open_arm, open_cell
from hardware.cell.settings import SIMULATED_CELL, CellSettings, read_cell

__all__ = ["SIMULATED_CELL", "Arm", "Cell", "CellSettings", "open_arm", "open_cell", "read_cell"]
