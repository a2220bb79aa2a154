"""A scan in a process of its own, to be killed: `python -m tests.hardware.scanning.kept_scan FOLDER`."""

from __future__ import annotations

import sys
from pathlib import Path

from hardware.cell import read_cell
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import world_with
from tests.hardware.scanning.faulty import SEED, WatchedRobot, scan_into

if __name__ == "__main__":

    def watch(cell):
        cell.robot = WatchedRobot(cell.robot, before=lambda k: print("move", k, flush=True))

    scan_into(Path(sys.argv[1]), world_with(builtin_object("mug"), read_cell().place, SEED), watch)
