"""Which collision model and how many substeps: retained candies against a fine reference, walls, time.

Prints a Markdown table over the objects in ../shared/data/objects (make collision-table), in about 15 minutes
on two cores. The reference is the exact surface at 960 Hz. A candy went through a wall if its centre crossed
the true surface between two recorded moments, seen from the object. CPU seconds are of the drop alone.
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.collision import CollisionModel, build_collision_model
from core.errors import Cancelled
from core.geometry import transform_points
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.results import Drop
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere, Task, WorkerPool

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"
REFERENCE = "exact 960 Hz"
SLOW = "coacd"
PATIENCE_S = 60
VARIANTS: dict[str, dict[str, object]] = {
    REFERENCE: {"collision.method": "exact", "solver.rate_hz": 960},
    "exact, 1 substep": {"collision.method": "exact", "solver.substeps": 1},
    "exact, up to 10 substeps": {"collision.method": "exact"},
    "vhacd": {"collision.method": "vhacd"},
    "coacd": {"collision.method": "coacd"},
}


@dataclass(frozen=True)
class Row:
    """One object with one variant; `model_s` is the time to make the collision model."""

    n_drop: int
    n_in: int
    n_through: int
    model_s: float
    drop_cpu_s: float

    @property
    def omega(self) -> float:
        """Omega."""
        return self.n_in / self.n_drop


def measure(mesh: TriangleMesh, settings: dict[str, object]) -> Row:
    """Build the model, drop, and count; runs in a worker."""
    parameters = apply_settings(Parameters(), {"evidence.record_interval_s": 1 / 60, **settings})
    started = time.perf_counter()
    model: CollisionModel = build_collision_model(mesh, parameters.collision, Reporter())
    model_s = time.perf_counter() - started
    started = time.process_time()
    found = imagine_drop(ImaginationContext(parameters, RunHere(), Reporter()), model)
    drop_cpu_s = time.process_time() - started
    return Row(found.n_drop, found.n_in, count_through_walls(mesh, found), model_s, drop_cpu_s)


def count_through_walls(mesh: TriangleMesh, found: Drop) -> int:
    """Count the candies whose centre crossed the surface."""
    import open3d

    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.uint32))
    recording = found.recording
    inverse = np.linalg.inv(recording.T_world_body)
    positions = np.stack(
        [transform_points(T, moment) for T, moment in zip(inverse, recording.positions_m, strict=True)]
    )
    starts, ends = positions[:-1].reshape(-1, 3), positions[1:].reshape(-1, 3)
    moves = ends - starts
    length = np.linalg.norm(moves, axis=1)
    real = np.isfinite(length) & (length > 1e-6)
    rays = np.hstack([starts[real], moves[real] / length[real, None]]).astype(np.float32)
    hit = scene.cast_rays(open3d.core.Tensor(rays), nthreads=1)["t_hit"].numpy()
    candies = np.tile(np.arange(positions.shape[1]), len(positions) - 1)[real]
    return len(np.unique(candies[hit < length[real]]))


def main(names: Sequence[str]) -> None:
    """Measure all objects, or those named, and print the table; Ctrl-C prints what there is."""
    with (OBJECTS / "manifest.csv").open(encoding="utf-8") as file:
        labels = {row["id"]: row["label"] for row in csv.DictReader(file)}
    chosen = list(names) or list(labels)
    meshes = {name: read_mesh(OBJECTS / "meshes" / f"{name}.obj", Reporter()) for name in chosen}
    rows: dict[tuple[str, str], Row] = {}
    with WorkerPool() as pool, suppress(KeyboardInterrupt):
        for name in chosen:
            for variants in ([v for v in VARIANTS if v != SLOW], [SLOW]):
                tasks = [Task(measure, (meshes[name], VARIANTS[variant])) for variant in variants]
                try:
                    measured = pool.run(tasks, name, Impatient())
                except Cancelled:
                    print(f"{name}: {', '.join(variants)} took over {PATIENCE_S} s", flush=True)
                    continue
                rows |= {(name, variant): row for variant, row in zip(variants, measured, strict=True)}
    measured_names = [name for name in chosen if (name, REFERENCE) in rows]
    print_table(rows, labels, measured_names)


class Impatient(Reporter):
    """Gives up after a while: CoACD does not end on every object."""

    def __init__(self) -> None:
        super().__init__()
        self._deadline_s = time.monotonic() + PATIENCE_S

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` when the time is up."""
        if time.monotonic() > self._deadline_s:
            raise Cancelled("The time is up.")


def print_table(rows: dict[tuple[str, str], Row], labels: dict[str, str], chosen: list[str]) -> None:
    """Print one line a variant, then one line an object."""
    columns = (
        "objects",
        "Omega off by, mean / worst",
        "through a wall",
        "accuracy at 0",
        "model s",
        "drop CPU s",
    )
    print("| variant | " + " | ".join(columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for variant in VARIANTS:
        names = [name for name in chosen if (name, variant) in rows]
        mine = [rows[name, variant] for name in names]
        omegas = np.array([row.omega for row in mine])
        off = np.abs(omegas - [rows[name, REFERENCE].omega for name in names])
        judged = [
            (omega > 0) == (labels[name] == "container")
            for name, omega in zip(names, omegas, strict=True)
            if labels[name] != "ambiguous"
        ]
        through, dropped = sum(row.n_through for row in mine), sum(row.n_drop for row in mine)
        print(
            f"| {variant} | {len(names)} | {off.mean():.3f} / {off.max():.3f} ({names[int(off.argmax())]}) "
            f"| {through} of {dropped} | {100 * np.mean(judged):.1f} % "
            f"| {np.mean([row.model_s for row in mine]):.2f} "
            f"| {np.mean([row.drop_cpu_s for row in mine]):.2f} |"
        )
    print("\n| object | label | " + " | ".join(VARIANTS) + " |")
    print("|---|---" + "|---" * len(VARIANTS) + "|")
    for name in chosen:
        cells = [
            f"{rows[name, v].omega:.3f} ({rows[name, v].n_through})" if (name, v) in rows else "-"
            for v in VARIANTS
        ]
        print(f"| {name} | {labels[name]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main(sys.argv[1:])
