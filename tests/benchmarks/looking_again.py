"""Narrow vessels in the simulated cell: how deep the reconstruction is before and after looking again.

Usage: python -m tests.benchmarks.looking_again
"""

from __future__ import annotations

from time import perf_counter

from core.progress import Reporter
from hardware.scanning.next_best_views import take_next_best_views
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import name_views
from tests.core.quality.studio import tube
from tests.hardware.scanning.test_next_best_views import depth_m, scanning

SIZES_M = ((0.03, 0.15), (0.03, 0.2), (0.04, 0.15), (0.04, 0.2), (0.05, 0.2))
"""Opening and depth."""
SEEDS = (0, 1, 2)


def main() -> None:
    """Measure all sizes and seeds."""
    for opening_m, true_m in SIZES_M:
        for seed in SEEDS:
            with scanning(tube(opening_m, true_m), seed) as cell:
                procedure = ScanProcedure(cell, None, Reporter())
                procedure.take(name_views(cell.views_rad))
                before_m = depth_m(procedure.scan())
                started_s = perf_counter()
                n_views = take_next_best_views(cell, procedure, Reporter())
                took_s = perf_counter() - started_s
                after_m = depth_m(procedure.scan())
            print(
                f"opening {opening_m * 1e3:.0f} mm, depth {true_m * 1e3:.0f} mm, seed {seed}: "
                f"{before_m * 1e3:.0f} -> {after_m * 1e3:.0f} mm with {n_views} views in {took_s:.0f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
