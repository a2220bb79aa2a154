from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

from core.errors import InputError
from core.imagination.cup import inner_radius_m
from hardware.simulation.pour_outcome.candies import fill_cup, hull_m, inertia_kg_m2, skin_m
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from tests.hardware.simulation.pour_outcome.paths import CUP


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("shape", ["lentil", "tablet"])
def test_candies_start_inside_the_cup_and_apart(shape: str, seed: int) -> None:
    settings = OutcomeSettings(seed=seed, candy_shape=shape)
    candies = fill_cup(CUP, settings)
    turns = Rotation.from_quat(candies.quaternions)
    hulls = np.array(
        [
            turn.apply(hull_m(settings, scale)) + position
            for turn, scale, position in zip(turns, candies.scales, candies.positions_m, strict=True)
        ]
    )
    skins = np.array([skin_m(settings, scale) for scale in candies.scales])[:, None]
    assert (np.hypot(hulls[..., 0], hulls[..., 1]) + skins < inner_radius_m(CUP, hulls[..., 2])).all()
    assert (hulls[..., 2] - skins > CUP.wall_m).all()
    assert (hulls[..., 2] + skins < CUP.length_m).all()
    pairs = np.array(list(combinations(range(60), 2)))
    gaps = [cdist(hulls[one], hulls[other]).min() for one, other in pairs]
    assert (gaps > (skins[pairs[:, 0]] + skins[pairs[:, 1]])[:, 0]).all()


def test_sizes_scatter_as_told() -> None:
    scales = fill_cup(CUP, OutcomeSettings(size_spread=0.05)).scales
    assert 0.03 < scales.std() < 0.07
    assert (fill_cup(CUP, OutcomeSettings(size_spread=0)).scales == 1).all()


def test_a_pours_candies_are_larger_or_smaller_all_alike() -> None:
    batches = [
        fill_cup(CUP, OutcomeSettings(seed=seed, n_candies=50, size_spread=0, batch_spread=0.2)).scales
        for seed in range(20)
    ]
    assert all(np.ptp(scales) == 0 for scales in batches)
    sizes = [scales[0] for scales in batches]
    assert 0.8 <= min(sizes) < 0.9
    assert 1.1 < max(sizes) <= 1.2


def test_hull_and_skin_together_have_the_candys_size() -> None:
    settings = OutcomeSettings(candy_diameter_m=0.02, candy_height_m=0.008)
    reach = hull_m(settings, 1.1).max(axis=0) + skin_m(settings, 1.1)
    assert reach == pytest.approx([0.011, 0.011, 0.0044])


def test_inertia_is_that_of_a_solid_of_the_candys_volume() -> None:
    """Against a sum over a fine grid of points."""
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 81)] * 3), axis=-1).reshape(-1, 3)
    usual = OutcomeSettings()
    half_m = np.array([usual.candy_diameter_m, usual.candy_diameter_m, usual.candy_height_m]) / 2
    for shape, is_inside in (
        ("lentil", (grid**2).sum(axis=1) < 1),
        ("tablet", (grid[:, :2] ** 2).sum(axis=1) < 1),
    ):
        x, y, z = (grid[is_inside] * half_m).T
        expected = usual.candy_mass_kg * np.array(
            [np.mean(y**2 + z**2), np.mean(x**2 + z**2), np.mean(x**2 + y**2)]
        )
        settings = OutcomeSettings(candy_shape=shape)
        assert inertia_kg_m2(settings, 1.0) == pytest.approx(expected, rel=0.05)


def test_too_many_candies_are_refused_with_what_fits() -> None:
    with pytest.raises(InputError, match="not for 500"):
        fill_cup(CUP, OutcomeSettings(n_candies=500))
