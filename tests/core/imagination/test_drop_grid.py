from math import ceil, floor, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import StageError
from core.imagination.drop import drop_positions, grid_counts
from core.parameters import Parameters, load_preset
from core.parameters.imagination import ContainabilityParameters

sizes = st.floats(0.01, 0.6)
LIMITS = load_preset("authors").containability


def test_the_authors_tray_gets_the_authors_308_candies():
    # 254.7 x 99.3 mm padded by 3 mm, a candy of 9 mm: 28 x 11 by the rule; their program drops 308.
    counts = grid_counts(np.array([0.260651, 0.105273, 0.0492]), np.array([0.009, 0.009]), LIMITS)
    assert counts == (28, 11, 1)


@given(sizes, sizes, st.integers(70, 400), st.integers(1, 70))
def test_the_rule_of_the_paper(width, depth, n_max, n_min):
    pitch, limits = 0.009, ContainabilityParameters(n_max=n_max, n_min=n_min)
    n_x, n_y, n_z = grid_counts(np.array([width, depth, 0.1]), np.array([pitch, pitch]), limits)
    first_x, first_y = floor(width / pitch), floor(depth / pitch)
    if first_x * first_y > n_max:
        s = sqrt(n_max / (first_x * first_y))
        assert (n_x, n_y, n_z) == (max(floor(s * width / pitch), 1), max(floor(s * depth / pitch), 1), 1)
    elif first_x * first_y < n_min:
        assert (n_x, n_y, n_z) == (first_x, first_y, ceil(n_min / (first_x * first_y)))
    else:
        assert (n_x, n_y, n_z) == (first_x, first_y, 1)


@pytest.mark.parametrize(("preset", "layers"), [("paper", 2), ("authors", 3)])
def test_at_32_candies_the_text_has_two_layers_and_the_code_three(preset, layers):
    limits = load_preset(preset).containability
    counts = grid_counts(np.array([0.073, 0.037, 0.1]), np.array([0.009, 0.009]), limits)
    assert counts == (8, 4, layers)


def test_an_object_smaller_than_a_candy_is_refused():
    with pytest.raises(StageError, match=r"smaller than a candy \(9\.0 mm"):
        grid_counts(np.array([0.008, 0.1, 0.1]), np.array([0.009, 0.009]), LIMITS)


def test_layers_start_1_cm_above_and_are_5_cm_apart():
    parameters = load_preset("paper")
    aabb = np.array([[0, 0, 0], [0.05, 0.05, 0.03]])
    positions = drop_positions(
        aabb,
        parameters.particle,
        parameters.containability.model_copy(update={"jitter_m": 0.0}),
        np.random.default_rng(0),
    )
    assert np.unique(positions[:, 2].round(6)).tolist() == pytest.approx(
        [0.04 + 0.05 * layer for layer in range(8)]
    )
    assert positions[:, :2].min() == 0
    assert positions[:, :2].max() == pytest.approx(0.05)


def test_jitter_is_seeded_and_bounded():
    parameters = Parameters()
    aabb = np.array([[0, 0, 0], [0.1, 0.1, 0.05]])

    def positions(seed):
        generator = np.random.default_rng(seed)
        return drop_positions(aabb, parameters.particle, parameters.containability, generator)

    assert (positions(1) == positions(1)).all()
    assert np.abs(positions(1) - positions(2)).max() <= 2 * parameters.containability.jitter_m
    assert (positions(1) != positions(2)).any()
