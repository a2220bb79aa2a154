"""Many pours in a row with one program: do memory, files, threads or processes grow? `make pour-soak`."""

from __future__ import annotations

import argparse
import tempfile
import threading
import time
from pathlib import Path

import psutil

from core.session.pour_runs import PourRun
from tests.hardware.pouring.rig import Rig

EVERY = 10


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--speed-up", type=float, default=4.0)
    args = parser.parse_args()
    began_s = time.monotonic()
    print("pours    s   MB (program, children)   files  threads  processes")
    with tempfile.TemporaryDirectory() as folder, Rig(Path(folder), args.speed_up) as rig:
        for k in range(args.number + 1):
            if k % EVERY == 0:
                print(f"{k:5d} {time.monotonic() - began_s:5.0f} {held()}", flush=True)
            if k < args.number:
                run = rig.pouring.carry_out(rig.pouring.plan())
                assert PourRun.load(run).is_done
    print(f"afterwards: {held()}")


def held() -> str:
    """What this program and its children hold."""
    program = psutil.Process()
    children = program.children(recursive=True)
    megabytes = [process.memory_info().rss / 1e6 for process in (program, *children)]
    files = sum(process.num_fds() for process in (program, *children))
    sizes = ", ".join(f"{size:.0f}" for size in megabytes)
    return f"{sizes:>24} {files:7d} {threading.active_count():8d} {len(children):10d}"


if __name__ == "__main__":
    main()
