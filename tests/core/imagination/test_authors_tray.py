"""The authors' own example, with their parameters, on their own convex parts."""

import numpy as np
import pytest

from core.collision import read_collision_model
from core.imagination.imagine import imagine
from core.parameters import apply_settings, load_preset
from core.progress import Reporter


@pytest.fixture(scope="module")
def model(shared_data):
    path = shared_data / "real_scan/amazon_tray/reference/authors_vhacd.obj"
    return read_collision_model(path, load_preset("authors").collision, Reporter())


@pytest.mark.parametrize("seed", range(5))
def test_the_authors_verdict_and_spills_come_out(model, pool, seed):
    parameters = apply_settings(load_preset("authors"), {"seed": seed})
    result = imagine(model, parameters, pool, Reporter())
    assert result.containability.n_drop == 308
    assert 0.46 <= result.containability.omega <= 0.55
    spilled = 60 - result.grid.n_in[:, :, 0]
    assert (spilled[[0, 4]] == 0).all(), spilled
    assert (spilled[[2, 6], 2] >= 50).all(), spilled
    assert result.choice.i in {0, 4}
    assert np.abs(result.containability.footprint.axis_rad) < 0.2
