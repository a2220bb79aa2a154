"""How long a person waits after the last view (make decision): for the verdict, and for the chosen pour.

Usage: python -m tests.benchmarks.decision [--objects DIR] [--others 5] [--only NAME ...]
The labelled containers and some others are scanned in the simulated cell, one after the other with the same
workers, as the window does. What is computed while an arm scans is computed before the first of them, for a
scan by an arm takes longer than that; the views, also the last, are read. Times are from the last view on.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import psutil

from app.operations.ahead import ViewsAhead, runs_ahead
from app.operations.scanning import scan_object
from app.operations.session import SessionTask, working_on
from core.errors import PoursightError
from core.evaluation.labels import LabelledObject, read_labels
from core.imagination.imagination import WORKER_MODULE
from core.parameters import Parameters
from core.pipeline.jobs import JOBS_MODULE
from core.pipeline.rehearsal import rehearse_in
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.cell import read_cell

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"


def main() -> None:
    """Measure, print a row for each object, then medians and worst."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.decision", description=__doc__)
    parser.add_argument("--objects", type=Path, default=OBJECTS)
    parser.add_argument("--others", type=int, default=5, help="how many that are no containers")
    parser.add_argument("--only", nargs="*", default=())
    given = parser.parse_args()
    labelled = read_labels(given.objects)
    chosen = [one for one in labelled if one.label == "container"]
    chosen += [one for one in labelled if one.label == "non-container"][: given.others]
    chosen = [one for one in chosen if not given.only or one.name in given.only]
    rows = []
    print(f"{'':24}{'verdict s':>10}{'pour s':>10}{'processor s':>13}")
    with WorkerPool() as pool, TemporaryDirectory(prefix="poursight-decision-") as folder:
        pool.start(WORKER_MODULE, JOBS_MODULE)
        rehearse_in(pool, Reporter())
        ahead = runs_ahead(Parameters(), pool, Reporter())
        while ahead.make_some():
            pass
        for one in chosen:
            try:
                rows.append(decision(one, pool, Path(folder) / one.name))
            except PoursightError as error:
                print(f"{one.name:24}{error}", flush=True)
                continue
            print(f"{one.name:24}" + "".join(f"{value:10.1f}" for value in rows[-1]), flush=True)
    for name, of in (("median", median), ("worst", max)):
        print(f"{name:24}" + "".join(f"{of(column):10.1f}" for column in zip(*rows, strict=True)))


def decision(one: LabelledObject, pool: WorkerPool, folder: Path) -> tuple[float, float, float]:
    """Return seconds from the last view to the verdict and to the chosen pour, and of processors."""
    with working_on(SessionTask(folder, Parameters(), "default"), pool, Reporter()) as pipeline:
        scan_object(pipeline, read_cell(), str(one.mesh))
        ViewsAhead(folder / "scan", Parameters(), pool).read(Reporter())
        began_s, began_cpu_s = perf_counter(), processor_s()
        pipeline.result("judgement")
        verdict_s = perf_counter() - began_s
        pipeline.result("risk")
        pour_s = perf_counter() - began_s
        pipeline.imagination()  # how firmly it holds is known later, and costs what it costs
        return verdict_s, pour_s, processor_s() - began_cpu_s


def processor_s() -> float:
    """Return the processor time of this process and its children so far."""
    own = psutil.Process()
    times = [process.cpu_times() for process in (own, *own.children(recursive=True))]
    return sum(time.user + time.system for time in times)


if __name__ == "__main__":
    main()
