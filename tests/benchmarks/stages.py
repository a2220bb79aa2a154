"""Times of every stage, and how much of the physics is spent in Bullet's own step (make bench).

Uses the authors' tray in ../shared/data: the images with the default preset, and Omega with 24 pours on the
authors' convex parts with preset `authors`. Wall seconds with all workers; the share of Bullet's step is
measured in one process, in CPU seconds, because that is what the engine sets as the floor.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from core.collision import CollisionModel, read_collision_model
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns
from core.imagination.drop import imagine_drop
from core.imagination.engine import bullet
from core.imagination.imagination import WORKER_MODULE
from core.imagination.pours import (
    imagine_pours,
)
from core.parameters import Parameters, load_preset
from core.pipeline.in_memory import imagine
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.scan import read_scan
from core.session import Session
from core.workers import RunHere, Task, WorkerPool

TRAY = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "real_scan" / "amazon_tray"
REPEATS = 3


def main() -> None:
    """Measure and print."""
    if not TRAY.is_dir():
        sys.exit(f"poursight: the benchmark needs {TRAY}, which is not there.")
    authors = load_preset("authors")
    model = read_collision_model(TRAY / "reference" / "authors_vhacd.obj", authors.collision, Reporter())
    print_engine_share(model, authors)
    with WorkerPool() as pool:
        pool.run([Task(_peak_memory_mb, ())] * pool.workers, "start", Reporter())
        print(f"\nOmega and 24 pours, preset authors, {pool.workers} workers (pool start not counted):")
        for _ in range(REPEATS):
            started = time.perf_counter()
            imagine(model, authors, pool, Reporter())
            print(f"  {time.perf_counter() - started:.2f} s")
        peak = max(pool.run([Task(_peak_memory_mb, ())] * pool.workers, "memory", Reporter()))
        print(f"  largest worker: {peak:.0f} MB")
        print_stages(pool)


def print_engine_share(model: CollisionModel, parameters: Parameters) -> None:
    """Print CPU seconds and the share of Bullet's step, in this process."""
    step_s = 0.0
    original = bullet.stepSimulation

    def timed(**arguments: Any) -> None:
        nonlocal step_s
        started = time.process_time()
        original(**arguments)
        step_s += time.process_time() - started

    def show(name: str, work: Callable[[], Any]) -> Any:
        nonlocal step_s
        step_s, started = 0.0, time.process_time()
        result = work()
        whole = time.process_time() - started
        print(f"  {name:<22}{whole:6.2f} s, of which {100 * step_s / whole:3.0f} % in Bullet's step")
        return result

    bullet.stepSimulation = timed
    print("One process, CPU seconds, preset authors on the authors' convex parts:")
    try:
        context, runs = ImaginationContext(parameters, RunHere(), Reporter()), CupRuns()
        found = show("drop", lambda: imagine_drop(context, model))
        show("cup run", lambda: runs.of_packings(context))
        show("24 replayed pours", lambda: imagine_pours(context, model, found.footprint, runs))
    finally:
        bullet.stepSimulation = original


def print_stages(pool: WorkerPool) -> None:
    """Print the seconds of each stage from the images to the report, default preset."""
    print("\nFrom the images to the report, default preset:")
    with TemporaryDirectory() as folder, Session.create_or_open(Path(folder) / "session") as session:
        pipeline = Pipeline(session, Parameters(), pool, Reporter())
        pool.run([Task(reconstruct_twice, ())], "compile", Reporter())
        for name, stage in (
            ("import", lambda: pipeline.import_scan(TRAY)),
            ("reconstruction", pipeline.reconstruction),
            ("collision", pipeline.collision),
            ("imagination", pipeline.imagination),
            ("evidence", pipeline.evidence),
            ("report", pipeline.report),
        ):
            started = time.perf_counter()
            stage()
            print(f"  {name:<22}{time.perf_counter() - started:6.2f} s")
        size = sum(path.stat().st_size for path in session.path.rglob("*.npz"))
        print(f"  recorded poses and models: {size / 1e6:.1f} MB")


def reconstruct_twice() -> None:
    """Fuse once to load what numba has compiled; runs in a worker."""
    reconstruct(read_scan(TRAY, Reporter()), Parameters().reconstruction, Reporter())


def _peak_memory_mb() -> float:
    __import__(WORKER_MODULE)
    time.sleep(0.2)  # so that each worker takes one of these tasks
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
