"""The authors' own example, with their parameters, on their own convex parts."""

import numpy as np
import pytest

from core.collision import read_collision_model
from core.parameters import apply_settings, load_preset
from core.pipeline.in_memory import imagine
from core.progress import Reporter

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def model(shared_data):
    path = shared_data / "real_scan/amazon_tray/reference/authors_vhacd.obj"
    return read_collision_model(path, load_preset("authors").collision, Reporter())


RELEASED = np.array(
    [[0, 0, 0], [0, 0, 6], [6, 0, 58], [0, 0, 6], [0, 0, 0], [0, 0, 2], [4, 0, 51], [0, 0, 1]]
)
"""Spilled of 60, by direction and distance: the result that lies with their data."""
SEEDS = 5


@pytest.fixture(scope="module")
def results(model, pool):
    return [
        imagine(model, apply_settings(load_preset("authors"), {"seed": seed}), pool, Reporter())
        for seed in range(SEEDS)
    ]


def spilled(result):
    return 60 - result.grid.n_in[:, :, 0]


def test_the_authors_verdict_and_choice_come_out(results):
    for result in results:
        assert result.containability.n_drop == 308
        assert 0.46 <= result.containability.omega <= 0.55
        assert (spilled(result)[[0, 4]] == 0).all(), spilled(result)
        assert (spilled(result)[[2, 6], 2] >= 50).all(), spilled(result)
        assert result.choice.i in {0, 4}
        assert np.abs(result.containability.footprint.axis_rad) < 0.2


def test_without_jitter_the_seed_changes_no_drop(results):
    assert len({result.containability.omega for result in results}) == 1


def test_the_mean_spill_of_each_of_the_24_pours_is_that_of_the_released_result(results):
    """What differs most, with its size, is in the README: two oblique pours from far out."""
    off = np.abs(np.mean([spilled(result) for result in results], axis=0) - RELEASED)
    far = np.zeros_like(off, dtype=bool)
    far[[1, 3], 2] = True
    assert off[~far].max() < 9, off
    assert off[far].max() < 20, off
    assert off.mean() < 2.5, off
