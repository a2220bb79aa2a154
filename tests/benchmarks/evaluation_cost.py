"""What an object costs in an evaluation, as objects and workers become more (make evaluation-cost).

Usage: python -m tests.benchmarks.evaluation_cost [--input scan|mesh] [--counts 10,45,200] [--workers 1,2]
           [--pours 3] [--objects DIR] [name=value ...]
More trials than there are objects are made by repeating these with other seeds. Everything counts: starting
the workers, and writing the results.
"""

from __future__ import annotations

import argparse
import csv
from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from app.operations.evaluating import EvaluationRequest, evaluate, interleaved, prepared_objects
from app.operations.evaluation.engine import LocalEngine
from core.evaluation.evaluation import Evaluation
from core.evaluation.variants import METHOD, variants_of
from core.parameters import Parameters, apply_settings
from core.progress import Reporter

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"


def main() -> None:
    """Measure and print a row for each number of trials and workers."""
    options = arguments()
    parameters = apply_settings(Parameters(), dict(text.split("=", 1) for text in options.settings))
    print(f"--input {options.input}, {options.pours} pours into each object judged a container")
    columns = {
        "trials": 7,
        "workers": 9,
        "wall s": 9,
        "s an object": 13,
        "at work s": 11,
        "busy": 7,
        "failed": 8,
    }
    print("".join(name.rjust(width) for name, width in columns.items()))
    for count in numbers(options.counts):
        for workers in numbers(options.workers):
            with TemporaryDirectory(prefix="poursight-cost-") as folder:
                request = request_of(options, count, parameters, Path(folder))
                began_s = perf_counter()
                found = evaluate(request, LocalEngine(workers), Path(folder) / "out", Reporter())
                print_row(found, workers, perf_counter() - began_s)


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.evaluation_cost")
    parser.add_argument("--input", choices=("scan", "mesh"), default="scan")
    parser.add_argument("--counts", default="10,45,200")
    parser.add_argument("--workers", default="1,2")
    parser.add_argument("--pours", type=int, default=3)
    parser.add_argument("--objects", type=Path, default=OBJECTS)
    parser.add_argument("settings", nargs="*", metavar="name=value")
    return parser.parse_args()


def numbers(text: str) -> list[int]:
    """Read numbers with commas between them."""
    return [int(word) for word in text.split(",")]


def request_of(
    options: argparse.Namespace, count: int, parameters: Parameters, folder: Path
) -> EvaluationRequest:
    """Ask for about `count` trials: as many objects as there are, then seeds."""
    whole = EvaluationRequest(
        options.objects,
        None,
        options.input,
        (0,),
        variants_of([METHOD]),
        options.pours,
        "default",
        parameters,
    )
    objects = interleaved(prepared_objects(whole))
    n_seeds = ceil(count / len(objects))
    chosen = objects[: round(count / n_seeds)]
    labels = folder / "labels.csv"
    with labels.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("id", "label"))
        writer.writerows((one.labelled.name, one.labelled.label) for one in chosen)
    return EvaluationRequest(
        options.objects,
        labels,
        options.input,
        tuple(range(n_seeds)),
        whole.variants,
        options.pours,
        "default",
        parameters,
    )


def print_row(found: Evaluation, workers: int, wall_s: float) -> None:
    """Print what one evaluation cost."""
    n = len(found.trials)
    at_work_s = sum(trial.total_s for trial in found.trials)
    failed = sum(bool(trial.problem) for trial in found.trials)
    print(
        f"{n:>7}{workers:>9}{wall_s:>9.1f}{wall_s / n:>13.2f}{at_work_s / n:>11.2f}"
        f"{at_work_s / wall_s / workers:>7.0%}{failed:>8}",
        flush=True,
    )


if __name__ == "__main__":
    main()
