import numpy as np
import pytest

from core.imagination.capacity.result import Capacity
from core.parameters import Parameters, apply_settings


def capacity_of(n_candies, heights_m=(), volumes_ml=(), spread=0.0) -> Capacity:
    """A capacity with a curve of height and volume; all candies lie below the rim."""
    heights, volumes = np.array(heights_m, dtype=float), np.array(volumes_ml, dtype=float)
    volume = float(volumes[-1]) if len(volumes) else 0.0
    rim = float(heights[-1]) if len(heights) else 0.0
    return Capacity(
        n_candies=n_candies,
        spread=spread,
        volume_ml=volume,
        heaped_ml=0.0,
        geometric_volume_ml=volume,
        candy_hollow_ml=volume,
        candy_scale=1.0,
        n_poured=(),
        n_full=(),
        n_kept=(),
        rim_height_m=rim,
        fill_height_m=rim,
        explanation="",
        heights_m=heights,
        volumes_ml=volumes,
        candies_per_ml=n_candies / volume if volume and n_candies else 0.9,
        recording=None,
    )


def cylinder(n_candies, radius_m=0.03, height_m=0.1, spread=0.0) -> Capacity:
    return capacity_of(n_candies, (0, height_m), (0, np.pi * radius_m**2 * height_m * 1e6), spread)


def cone(n_candies, radius_m=0.05, height_m=0.1) -> Capacity:
    """A cone standing on its tip."""
    heights = np.linspace(0, height_m, 201)
    radii = radius_m * heights / height_m
    return capacity_of(n_candies, heights, np.pi * radii**2 * heights / 3 * 1e6)


@pytest.fixture
def planned() -> Parameters:
    """Cup and candy given explicitly: the cup has room for 120, and for 82 that are 5 % larger."""
    return apply_settings(
        Parameters(),
        {
            "pouring.n_pour": 60,
            "pouring.cup.length_m": 0.111,
            "pouring.cup.mouth_radius_m": 0.0333,
            "pouring.cup.slant_rad": 0.028575,
            "pouring.cup.wall_m": 0.002,
            "particle.shape": "ellipsoid",
            "particle.diameter_m": 0.0132,
            "particle.height_m": 0.007,
            "risk.candy_spread": 0.05,
        },
    )
