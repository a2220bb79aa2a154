"""What does a poorly calibrated cell choose, beside a well calibrated one, and how sure is it?

Usage: python -m tests.benchmarks.calibration_choice [OBJECT ...] [--good MM DEGREES] [--poor MM DEGREES]
An object is a built-in one or a mesh file. Errors are standard deviations along and about an axis, as a scan
of a calibrated cell records them. An object's pours are imagined once, and tried as the program tries them:
once with the good cell's errors, once with the poor one's. Printed are the pours chosen, direction and
distance, how many of their tries were clean, and the lower 95 % bound of their chance to spill nothing.
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


def said(tries: Tries) -> str:
    """A choice, and how sure it is."""
    if tries.choice is None or tries.risk is None:
        return "no pour"
    i, j = tries.choice.i, tries.choice.j
    clean, tried, least = (
        table[i, j] for table in (tries.risk.n_clean, tries.risk.n_tries, tries.risk.clean_at_least)
    )
    return f"pour {i + 1}.{j + 1} ({clean} of {tried}, {least:.0%})"


def main() -> None:
    """Run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("objects", nargs="*", default=["glass", "vase"])
    parser.add_argument("--good", nargs=2, type=float, default=(0.12, 0.03), metavar=("MM", "DEGREES"))
    parser.add_argument("--poor", nargs=2, type=float, default=(1.0, 0.3), metavar=("MM", "DEGREES"))
    chosen = parser.parse_args()
    cells = {
        title: with_camera_error(Parameters(), mm / 1000, float(np.radians(degrees)))
        for title, (mm, degrees) in (("good", chosen.good), ("poor", chosen.poor))
    }
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE, JOBS_MODULE)
        tools = Tools(pool, Reporter())
        for name in chosen.objects:
            try:
                memory = StageMemory(given_mesh(name), tools)
                found = [f"{title} {said(memory.result('risk', one))}" for title, one in cells.items()]
            except PoursightError as error:
                found = [str(error)]
            print(f"{Path(name).stem:24}{', '.join(found)}", flush=True)


if __name__ == "__main__":
    main()
