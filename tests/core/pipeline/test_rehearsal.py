from __future__ import annotations

import numpy as np
import pytest

from core.collision import build_collision_model
from core.imagination.capacity.water import find_basin
from core.parameters import Parameters
from core.pipeline.rehearsal import rehearse, rehearse_in, small_scan
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.workers import Task, WorkerPool


def rehearsed() -> bool:
    return rehearse.cache_info().currsize == 1


def test_the_small_scan_goes_through_all_that_a_scan_does():
    """Else something is loaded after the last view only."""
    parameters, reporter = Parameters(), Reporter()
    found = reconstruct(small_scan(), parameters.reconstruction, reporter)
    assert found.mesh.extents_m == pytest.approx([0.038, 0.038, 0.030], abs=0.004)
    assert found.refinement is not None
    model = build_collision_model(found.mesh, parameters.collision, reporter)
    assert len(model.surface.faces) < len(found.mesh.faces)
    basin = find_basin(model.surface, parameters.particle.diameter_m, 0.0, 100_000)
    assert 10 < basin.candies_ml < 30 * 30 * 26 / 1000, "round candies leave the corners"
    assert np.isfinite(basin.rim_m)


def test_each_worker_rehearses():
    with WorkerPool(2) as pool:
        rehearse_in(pool, Reporter())
        assert pool.run([Task(rehearsed, ())] * 2, "asked", Reporter()) == [True, True]
