"""How firmly each labelled object holds, as it is scanned: load, tilts, what stays, sentence.

Usage: python -m tests.benchmarks.holding [--seeds 0,1] [--pick NAME ...] [--load 24] [--to 90] [--csv FILE]
Tilts are those of the worst direction, in degrees; "-": it never left. "kept" are the candies left
at a tilt as a share of those asked for (--load), in the worst direction and in the mean. Seconds are of one
process.
"""

from __future__ import annotations

import argparse
import csv
from math import degrees, isinf, radians
from pathlib import Path
from time import perf_counter
from typing import Any

from app.evaluation.standing import known_surface, stand
from core.collision import build_collision_model
from core.evaluation.labels import LabelledObject, read_labels
from core.imagination.holding.imagine import imagine_holding
from core.imagination.holding.result import Holding
from core.imagination.holding.words import holding_sentence
from core.imagination.imagine import WORKER_MODULE, imagine_containability
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.parameters.holding import HoldingParameters
from core.progress import Reporter
from core.workers import RunHere, Task, WorkerPool

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"
KEPT_AT_DEG = (15, 20, 30, 45)


def measure(one: LabelledObject, seed: int, settings: HoldingParameters) -> dict[str, Any]:
    """Scan an object, drop candies on it and tilt it, in a worker; without a tilt if no candy stayed."""
    parameters = apply_settings(Parameters(), {"seed": seed})
    mesh = read_mesh(one.mesh, Reporter())
    known = known_surface(mesh, stand(mesh, "scan", seed), "scan", parameters, Reporter())
    model = build_collision_model(known, parameters.collision, Reporter())
    found = imagine_containability(model, parameters)
    row: dict[str, Any] = {"id": one.name, "label": one.label, "seed": seed, "omega": found.omega}
    row["n_in"] = found.n_in
    if found.footprint is None:
        return row
    began_s = perf_counter()
    holding = imagine_holding(model, found, parameters, settings, RunHere(), Reporter())
    return row | figures(holding) | {"seconds": perf_counter() - began_s}


def figures(holding: Holding) -> dict[str, Any]:
    """Return the columns of one object."""
    row: dict[str, Any] = {"n_asked": holding.n_asked, "load": holding.n_load}
    for name in ("first", "tenth", "half"):
        tilt = getattr(holding, f"{name}_rad")
        row[f"tilt_{name}_deg"] = "-" if isinf(tilt) else degrees(tilt)
    most = degrees(holding.tilt_rad[-1])
    for angle in (angle for angle in KEPT_AT_DEG if angle <= most):
        kept = holding.kept_of_asked_at(radians(angle))
        row |= {f"kept_{angle}_worst": kept.min(), f"kept_{angle}_mean": kept.mean()}
    return row | {"sentence": holding_sentence(holding)}


def printed(value: object) -> str:
    """Return a cell of the table."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def main() -> None:
    """Print the table, and write it to a file if one is named."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.holding")
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--pick", nargs="*")
    parser.add_argument("--load", type=int, default=HoldingParameters().n_load)
    parser.add_argument("--to", type=float, default=90.0, help="largest tilt, degrees")
    parser.add_argument("--csv", type=Path)
    asked = parser.parse_args()
    settings = HoldingParameters(n_load=asked.load, tilt_max_rad=radians(asked.to))
    objects = [one for one in read_labels(OBJECTS) if one.label != "ambiguous"]
    chosen = [one for one in objects if not asked.pick or one.name in asked.pick]
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        tasks = [
            Task(measure, (one, int(seed), settings)) for seed in asked.seeds.split(",") for one in chosen
        ]
        rows = pool.run(tasks, "holding", Reporter())
    names = list(dict.fromkeys(name for row in rows for name in row))
    print(f"| {' | '.join(names)} |")
    print(f"|{'---|' * len(names)}")
    for row in rows:
        print(f"| {' | '.join(printed(row.get(name, '')) for name in names)} |", flush=True)
    if asked.csv:
        with asked.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, names)
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
