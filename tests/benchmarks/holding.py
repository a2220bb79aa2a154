"""How firmly each labelled object holds, as it is scanned: load, tilts, what stays, sentence.

Usage: python -m tests.benchmarks.holding [--seeds 0,1] [--pick NAME ...] [--load 24] [--to 90] [--csv FILE]
Tilts are those of the worst direction, in degrees; "-": it never left. "kept" are the candies left
at a tilt as a share of those requested (--load), in the worst direction and in the mean. Seconds are of one
process.
"""

from __future__ import annotations

import argparse
import csv
from math import degrees, isinf, radians
from pathlib import Path
from time import perf_counter
from typing import Any

from app.operations.evaluation.placed_object import known_surface, place_object
from core.collision import build_collision_model
from core.evaluation.labels import LabelledObject, read_labels
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.imagination import WORKER_MODULE
from core.imagination.retention.imagine import imagine_retention
from core.imagination.retention.result import Retention, retention_sentence
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.parameters.imagination import RetentionParameters
from core.progress import Reporter
from core.workers import RunHere, Task, WorkerPool

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"
KEPT_AT_DEG = (15, 20, 30, 45)


def measure(one: LabelledObject, seed: int, settings: RetentionParameters) -> dict[str, Any]:
    """Scan an object, drop candies on it and tilt it, in a worker; without a tilt if no candy stayed."""
    parameters = apply_settings(Parameters(), {"seed": seed})
    mesh = read_mesh(one.mesh, Reporter())
    known = known_surface(mesh, place_object(mesh, "scan", seed), "scan", parameters, Reporter())
    model = build_collision_model(known.mesh, parameters.collision, Reporter())
    context = ImaginationContext(parameters.model_copy(update={"holding": settings}), RunHere(), Reporter())
    drop = imagine_drop(context, model)
    row: dict[str, Any] = {"id": one.name, "label": one.label, "seed": seed, "omega": drop.omega}
    row["n_in"] = drop.n_in
    if drop.footprint is None:
        return row
    began_s = perf_counter()
    retention = imagine_retention(context, model, drop)
    return row | figures(retention) | {"seconds": perf_counter() - began_s}


def figures(retention: Retention) -> dict[str, Any]:
    """Return the columns of one object."""
    row: dict[str, Any] = {"n_asked": retention.n_asked, "load": retention.n_load}
    for name in ("first", "tenth", "half"):
        tilt = getattr(retention, f"{name}_rad")
        row[f"tilt_{name}_deg"] = "-" if isinf(tilt) else degrees(tilt)
    most = degrees(retention.tilt_rad[-1])
    for angle in (angle for angle in KEPT_AT_DEG if angle <= most):
        kept = retention.kept_of_asked_at(radians(angle))
        row |= {f"kept_{angle}_worst": kept.min(), f"kept_{angle}_mean": kept.mean()}
    return row | {"sentence": retention_sentence(retention)}


def printed(value: object) -> str:
    """Return a cell of the table."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def main() -> None:
    """Print the table, and write it to a file if one is named."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.holding")
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--pick", nargs="*")
    parser.add_argument("--load", type=int, default=RetentionParameters().n_load)
    parser.add_argument("--to", type=float, default=90.0, help="largest tilt, degrees")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    settings = RetentionParameters(n_load=options.load, tilt_max_rad=radians(options.to))
    objects = [one for one in read_labels(OBJECTS) if one.label != "ambiguous"]
    chosen = [one for one in objects if not options.pick or one.name in options.pick]
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        tasks = [
            Task(measure, (one, int(seed), settings)) for seed in options.seeds.split(",") for one in chosen
        ]
        rows = pool.run(tasks, "holding", Reporter())
    names = list(dict.fromkeys(name for row in rows for name in row))
    print(f"| {' | '.join(names)} |")
    print(f"|{'---|' * len(names)}")
    for row in rows:
        print(f"| {' | '.join(printed(row.get(name, '')) for name in names)} |", flush=True)
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, names)
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
