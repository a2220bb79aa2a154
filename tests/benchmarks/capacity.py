"""Capacity by imagined filling of scanned objects, against a fill of their true meshes with water.

Usage: python -m tests.benchmarks.capacity [--seed N] [--pick NAME ...] [--real] [--packing]
`--real` fills with candies however many fit, where usually balls stand for them; that takes minutes.
`--packing` prints how densely the imagined particles lie in known cylinders and boxes instead, from which the
numbers in core/imagination/capacity/packing.py come.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time

import numpy as np

from app.operations.evaluation.placed_object import known_surface, place_object
from core.collision import build_collision_model
from core.evaluation.labels import LabelledObject, read_labels
from core.imagination.body import body_files
from core.imagination.capacity.filling import FillPlan, filling_task
from core.imagination.capacity.imagine import imagine_capacity
from core.imagination.capacity.result import Capacity
from core.imagination.capacity.stand_in import (
    BALLS,
    CANDIES,
    StandIn,
    ball_diameter_m,
    ball_of,
    candy_itself,
    particle_volume_m3,
)
from core.imagination.capacity.water import find_basin
from core.imagination.context import ImaginationContext
from core.imagination.drop import ObjectAtRest, imagine_drop
from core.imagination.imagination import WORKER_MODULE
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.parameters.imagination import CapacityParameters
from core.progress import Reporter
from core.reconstruction.result import Reconstruction
from core.workers import RunHere, Task, WorkerPool

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"
FINE_POINTS = 8_000_000
_MOST_REAL = 5000
_UNAMBIGUOUS = 0.05
"""Water and candies agree by this on the true mesh: it has neither cracks nor hollow walls that are open."""


@dataclass(frozen=True)
class Row:
    """One object: its capacity, the true volume in ml (water, and closed to candies), processor time."""

    capacity: Capacity
    true_ml: float
    true_hollow_ml: float
    seconds: float


def measure(one: LabelledObject, seed: int, changes: dict[str, float]) -> Row:
    """Scan an object, fill it in imagination, and its true mesh with water, in a worker."""
    parameters = apply_settings(Parameters(), {"seed": seed, **changes})
    mesh = read_mesh(one.mesh, Reporter())
    placed = place_object(mesh, "scan", seed)
    known = known_surface(mesh, placed, "scan", parameters, Reporter())
    assert isinstance(known, Reconstruction)
    model = build_collision_model(known.mesh, parameters.collision, Reporter())
    model = replace(model, surface_error_m=known.surface_error_m)
    context = ImaginationContext(parameters, RunHere(), Reporter())
    drop = imagine_drop(context, model)
    began_s = process_time()
    capacity = imagine_capacity(context, model, drop)
    seconds = process_time() - began_s
    true = find_basin(placed.true, parameters.particle.diameter_m, 1.0, FINE_POINTS)
    return Row(capacity, true.water_ml, true.candies_ml, seconds)


def print_capacities(objects: list[LabelledObject], seed: int, changes: dict[str, float]) -> None:
    """Print a row for each object, and how far those are off whose capacity is beyond doubt."""
    names = [
        "object",
        "candies",
        "spread",
        "ml imagined",
        "ml told",
        "ml geometric",
        "ml true",
        "error",
        "ball",
        "CPU s",
        "why",
    ]
    print(f"| {' | '.join(names)} |\n|{'---|' * len(names)}", flush=True)
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        rows = pool.run([Task(measure, (one, seed, changes)) for one in objects], "capacity", Reporter())
    errors = []
    for one, row in zip(objects, rows, strict=True):
        found: Capacity = row.capacity
        is_sure = abs(row.true_hollow_ml - row.true_ml) < _UNAMBIGUOUS * row.true_ml
        error = found.level_ml / row.true_ml - 1 if is_sure else float("nan")
        errors += [abs(error)] if is_sure else []
        cells = [
            one.name,
            f"{found.n_candies:.0f}",
            f"{found.spread:.0f}",
            f"{found.volume_ml:.0f}",
            f"{found.level_ml:.0f}",
            f"{found.geometric_volume_ml:.0f}",
            f"{row.true_ml:.0f}",
            f"{100 * error:+.1f} %" if is_sure else f"({row.true_hollow_ml:.0f} closed)",
            f"{found.candy_scale:.2f}",
            f"{row.seconds:.1f}",
            found.explanation,
        ]
        print(f"| {' | '.join(cells)} |")
    if errors:
        within = sum(error <= 0.1 for error in errors)
        print(f"\n{within} of {len(errors)} within 10 %; median error {100 * np.median(errors):.1f} %")


def cylinder(radius_m: float, height_m: float, sides: int = 32) -> TriangleMesh:
    """An open cylinder without thickness, placed on the origin."""
    angles = np.arange(sides) * 2 * np.pi / sides
    return _open_prism(radius_m * np.column_stack([np.cos(angles), np.sin(angles)]), height_m)


def tub(width_m: float, depth_m: float, height_m: float) -> TriangleMesh:
    """An open box without thickness, placed on the origin."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    return _open_prism(corners * [width_m, depth_m], height_m)


def _open_prism(outline_m: np.ndarray, height_m: float) -> TriangleMesh:
    n = len(outline_m)
    vertices = np.zeros((2 * n + 1, 3))
    vertices[:n, :2] = vertices[n : 2 * n, :2] = outline_m
    vertices[n : 2 * n, 2] = height_m
    faces = []
    for k in range(n):
        after = (k + 1) % n
        faces += [[k, after, n + after], [k, n + after, n + k], [2 * n, after, k]]
    return TriangleMesh(vertices, np.array(faces))


def share_below_rim(
    mesh: TriangleMesh, volume_m3: float, reach_m: float, stand_in: StandIn, filling: int
) -> float:
    """Fill an open prism and return which share of its volume the particles fill; in a worker."""
    grid = np.linspace(-reach_m, reach_m, 41)
    places = np.array([(x, y) for x in grid for y in grid])
    one_m3 = particle_volume_m3(stand_in.particle)
    basin = find_basin(mesh, ball_diameter_m(stand_in.particle), 1.0, 100_000)
    plan = FillPlan(stand_in, places, 0.58 * volume_m3 / one_m3, basin)
    with body_files(object=((mesh,), True)) as files:
        box = np.array([mesh.aabb_min_m, mesh.aabb_max_m])
        target = ObjectAtRest(files["object"], box, box.mean(axis=0))
        task = filling_task(target, plan, filling, Parameters(), CapacityParameters())
        return float(task.function(*task.arguments).n_kept * one_m3 / volume_m3)


def print_packing() -> None:
    """Print shares of balls and candies with the fit of floor and walls."""
    candy = Parameters().particle
    round_ones = [(0.04, 0.10), (0.06, 0.06), (0.10, 0.03), (0.025, 0.15)]
    boxes = [(0.08, 0.08, 0.08), (0.15, 0.10, 0.05), (0.05, 0.05, 0.12)]
    small = [(0.03, 0.05), (0.02, 0.06), (0.04, 0.04), (0.05, 0.05)]
    shapes = [(cylinder(r, h), np.pi * r * r * h, r, h, 2 / r) for r, h in round_ones]
    shapes += [(tub(a, b, h), a * b * h, b / 2, h, 2 / a + 2 / b) for a, b, h in boxes]
    tasks, sizes = [], []
    for mesh, volume, reach, height, side in shapes:
        for n in (60, 80, 100):
            ball = ball_of(Parameters(), (0.58 * volume / n / particle_volume_m3(candy)) ** (1 / 3))
            size_m = ball.particle.diameter_m
            for filling in (0, 1):
                tasks.append(
                    Task(share_below_rim, (mesh, volume, max(reach - 0.6 * size_m, 0.001), ball, filling))
                )
                sizes.append((size_m / height, size_m * side, True))
    for r, h in small:
        size_m = ball_diameter_m(candy)
        arguments = (cylinder(r, h), np.pi * r * r * h, r - 0.0075, candy_itself(Parameters()), 0)
        tasks.append(Task(share_below_rim, arguments))
        sizes.append((size_m / h, 2 * size_m / r, False))
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        shares = np.array(pool.run(tasks, "packing", Reporter()))
    for name, is_ball, used in (("balls", True, BALLS), ("candies", False, CANDIES)):
        chosen = np.array([one[2] is is_ball for one in sizes])
        walls = np.array([[1.0, -one[0], -one[1]] for one in sizes])[chosen]
        fit, *_ = np.linalg.lstsq(walls, shares[chosen], rcond=None)
        left = shares[chosen] - walls @ fit
        print(f"{name}: {len(left)} fillings, fit {fit.round(3)}, deviation {left.std():.3f}; used {used}")
        for row, share in zip(walls, shares[chosen], strict=True):
            print(f"  size / height {-row[1]:.2f}, against walls {-row[2]:.2f}: {share:.3f}")


def main() -> None:
    """Print one of the tables."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--pick", nargs="*", default=[])
    parser.add_argument("--real", action="store_true")
    parser.add_argument("--packing", action="store_true")
    chosen = parser.parse_args()
    if chosen.packing:
        print_packing()
        return
    objects = [one for one in read_labels(OBJECTS) if one.label == "container"]
    picked = [one for one in objects if not chosen.pick or one.name in chosen.pick]
    print_capacities(picked, chosen.seed, {"capacity.n_real": _MOST_REAL} if chosen.real else {})


if __name__ == "__main__":
    main()
