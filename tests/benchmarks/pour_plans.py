"""Which pours the simulated cell's arm can make: the data set's containers at random poses on the platform.

Usage: python -m tests.benchmarks.pour_plans [--poses 5]
Pivots are those of a footprint in the center of each object's box, so that nothing needs to be imagined.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from core.errors import InputError, MotionError
from core.geometry import FloatArray
from core.imagination.pours import indentations_m, pivots_m, pour_directions_rad
from core.imagination.results import Footprint
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.motion.pour.cell import PourCell
from core.motion.pour.planning import judge_pours
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.cell import CellSettings, read_cell
from hardware.cell.scene import pour_cell
from hardware.simulation.placing import place_on_platform, transform_mesh

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"
POURING = PouringParameters()


@dataclass(frozen=True)
class Judged:
    """One object at one pose: how many pours are feasible, and the figures."""

    n_feasible: int
    n_directions: int
    took_s: float
    clearance_m: float
    longest_rotation_s: float
    reason: str


def main() -> None:
    """Judge all containers and print a line for each, and the summary."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=5, help="random poses of each object")
    n_poses = parser.parse_args().poses
    settings = read_cell()
    cell = pour_cell(settings)
    everything: list[Judged] = []
    with WorkerPool() as pool:
        pool.start("core.motion.pour.planning")
        for name, mesh in containers():
            judged = [judge(cell, box, pool) for box in boxes(mesh, settings, n_poses)]
            everything += judged
            _print_line(name, judged)
    _summarize(everything)


def containers() -> Iterator[tuple[str, TriangleMesh]]:
    """All objects of the data set that are containers."""
    with (OBJECTS / "manifest.csv").open(encoding="utf-8") as table:
        names = [row["id"] for row in csv.DictReader(table) if row["label"] == "container"]
    for name in names:
        yield name, read_mesh(OBJECTS / "meshes" / f"{name}.obj", Reporter())


def boxes(mesh: TriangleMesh, settings: CellSettings, n_poses: int) -> Iterator[FloatArray]:
    """The object's axis-aligned box (2, 3) at random poses on the platform; none if it does not fit."""
    for seed in range(n_poses):
        try:
            pose = place_on_platform(mesh, seed, settings.place)
        except InputError as error:
            print(error, file=sys.stderr)
            return
        vertices = transform_mesh(mesh, pose).vertices_m
        yield np.array([vertices.min(axis=0), vertices.max(axis=0)])


def pours_onto(box_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions (8,) and pivots (8, 3, 3) for a footprint in the center of a box (2, 3)."""
    middle = box_m.mean(axis=0)
    height = box_m[1, 2] + POURING.pivot_height_m
    footprint = Footprint(np.array([*middle[:2], height]), 0.0, np.zeros(2))
    thetas = pour_directions_rad(footprint, POURING)
    return thetas, pivots_m(footprint, thetas, indentations_m(box_m, POURING))


def judge(cell: PourCell, box_m: FloatArray, pool: WorkerPool) -> Judged:
    """Judge the pours onto one box."""
    thetas, pivots = pours_onto(box_m)
    started_s = perf_counter()
    try:
        pours = judge_pours(cell, box_m, thetas, pivots, POURING, cell.home_rad, pool, Reporter())
    except MotionError as error:
        return Judged(0, 0, perf_counter() - started_s, 0.0, 0.0, str(error))
    took_s = perf_counter() - started_s
    fine = [pour for pour in pours if pour.is_feasible]
    if not fine:
        return Judged(0, 0, took_s, 0.0, 0.0, pours[0].reason)
    clearance = min(pour.clearance_m for pour in fine)
    rotation = max(pour.turn_s for pour in fine)
    return Judged(len(fine), len({pour.i for pour in fine}), took_s, clearance, rotation, "")


def _print_line(name: str, judged: list[Judged]) -> None:
    if not judged:
        print(f"{name:22} does not fit", flush=True)
        return
    numbers = " ".join(f"{one.n_feasible:2}" for one in judged)
    directions = " ".join(f"{one.n_directions}" for one in judged)
    times = (
        f"{np.median([one.took_s for one in judged]):.2f} (most {max(one.took_s for one in judged):.2f}) s"
    )
    nearest = min((one.clearance_m for one in judged if one.n_feasible), default=0.0)
    rotation = max(one.longest_rotation_s for one in judged)
    print(
        f"{name:22} feasible of 24: {numbers}, directions: {directions}, judged in {times}, smallest "
        f"clearance {nearest * 1000:.1f} mm, longest pour rotation {rotation:.2f} s",
        flush=True,
    )
    for pose, one in enumerate(judged):
        if not one.n_feasible:
            print(f"    pose {pose}: {one.reason}", flush=True)


def _summarize(judged: list[Judged]) -> None:
    n_fine = sum(one.n_feasible > 0 for one in judged)
    times = [one.took_s for one in judged]
    mean = np.mean([one.n_feasible for one in judged])
    print(
        f"{n_fine} of {len(judged)} placed objects have a feasible pour, {mean:.1f} of 24 on average; "
        f"judging took {np.median(times):.2f} s (median), {np.percentile(times, 95):.2f} s (95 %), "
        f"{max(times):.2f} s (most)"
    )


if __name__ == "__main__":
    main()
