"""What does a poorly calibrated cell choose, beside a well calibrated one, and how sure is it?

Usage: python -m tests.benchmarks.calibration_choice [OBJECT ...] [--good MM DEGREES]
       [--poor MM DEGREES] [--seed S]
An object is a built-in one or a mesh file. Errors are standard deviations along and about an axis, as a scan
of a calibrated cell records them. An object's pours are imagined once, and tried as the program tries them:
once with the good cell's errors, once with the poor one's. Printed are the pours chosen, direction and
distance, how many of their tries were clean, and the lower 95 % bound of their chance to spill nothing; where
the poor cell chooses another pour, also what the good cell's pour is worth there.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from core.errors import PoursightError
from core.imagination.imagination import WORKER_MODULE
from core.imagination.risk.drawing import with_camera_error
from core.imagination.risk.tries import Tries
from core.mesh_file import read_mesh
from core.parameters import Parameters
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.in_memory import StageMemory
from core.pipeline.jobs import JOBS_MODULE
from core.pipeline.running import Tools
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object


def given_mesh(name: str) -> GivenMesh:
    """A built-in object, or one from a file."""
    mesh = builtin_object(name) if name in BUILTIN_OBJECTS else read_mesh(Path(name), Reporter())
    return GivenMesh(mesh)


def said(tries: Tries, cell: tuple[int, int] | None) -> str:
    """A pour, and how sure it is."""
    if cell is None or tries.risk is None:
        return "no pour"
    clean, tried, least = (
        table[cell] for table in (tries.risk.n_clean, tries.risk.n_tries, tries.risk.clean_at_least)
    )
    return f"pour {cell[0] + 1}.{cell[1] + 1} ({clean} of {tried}, {least:.0%})"


def chosen_cell(tries: Tries) -> tuple[int, int] | None:
    """Direction and distance of the pour that is chosen."""
    return None if tries.choice is None else (tries.choice.i, tries.choice.j)


def compared(good: Tries, poor: Tries) -> str:
    """What both cells choose."""
    first, second = chosen_cell(good), chosen_cell(poor)
    line = f"good {said(good, first)}, poor {said(poor, second)}"
    return line if first == second else f"{line}; there {said(poor, first)}"


def main() -> None:
    """Run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("objects", nargs="*", default=["glass", "vase"])
    parser.add_argument("--good", nargs=2, type=float, default=(0.12, 0.03), metavar=("MM", "DEGREES"))
    parser.add_argument("--poor", nargs=2, type=float, default=(1.0, 0.3), metavar=("MM", "DEGREES"))
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    plain = Parameters().model_copy(update={"seed": chosen.seed})
    cells = {
        title: with_camera_error(plain, mm / 1000, float(np.radians(degrees)))
        for title, (mm, degrees) in (("good", chosen.good), ("poor", chosen.poor))
    }
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE, JOBS_MODULE)
        tools = Tools(pool, Reporter())
        for name in chosen.objects:
            try:
                memory = StageMemory(given_mesh(name), tools)
                found = compared(*(memory.result("risk", one) for one in cells.values()))
            except PoursightError as error:
                found = str(error)
            print(f"{Path(name).stem:24}{found}", flush=True)


if __name__ == "__main__":
    main()
