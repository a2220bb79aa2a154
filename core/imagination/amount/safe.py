"""How many candies fit so that none goes over the rim."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from core.imagination.capacity.result import Capacity
from core.parameters import Parameters

REPOSE = 0.5
"""Slope of a heap under the stream. The simulated table's is 0.26 (104 candies in a loaf tin, two pours:
17 mm high in the middle, its foot 65 mm from there). Real shells may be rougher; 27 degrees is steep for
smooth lentils."""
LIFTED = 0.29
"""How far the foot of a heap, on the side of the nearer wall, stands above the level of the same candies laid
flat: this times slope times radius, if the stream falls halfway between the middle and the wall of a round
mouth. The mean distance from there to a point of the mouth is 0.79 radii, to the nearer wall 0.5."""
_MOUTH_SHARE = 0.1
"""The uppermost tenth of the height tells how wide the mouth is."""
_SHALLOW = 0.5
"""Share of what fits for sure that is poured at least."""
_SDS = 2.0
"""Standard deviations of the capacity that are not counted on; of two fillings, as far below their mean as
they lie apart."""


def sure_candies(capacity: Capacity, parameters: Parameters) -> float:
    """Return how many fit, laid as flat as shaking lays them, if all errors are against it.

    Less by the fillings' spread, and by the volume of candies that are larger by `risk.candy_spread`.
    """
    least = max(capacity.n_candies - _SDS * capacity.spread, 0.0)
    return least / (1 + parameters.risk.candy_spread) ** 3


def safe_candies(capacity: Capacity, parameters: Parameters) -> int:
    """Return how many candies can be poured without one going over the rim; one at least.

    The capacity is counted after shaking, with the candies level. A pour heaps them under its stream, on the
    side of one wall, where their level is higher, and the last candies fall onto them and jump. So the level
    stays below the rim by the freeboard: what the heap lifts its foot at the wall (`LIFTED`), and a candy's
    diameter for the jump: falling from 10 mm above the rim onto others it keeps at most half of its speed,
    and so jumps a fourth as high, 6 to 8 mm. Below that level lies the same share of the candies below the
    rim as of the volume; those in a heap above the rim do not count.

    A wide, shallow object, or one whose lowest notch is far below what it holds, would have no level left,
    though the chosen pour heaps the candies away from there: half of what fits for sure is poured.
    """
    freeboard_m = LIFTED * REPOSE * _mouth_radius_m(capacity) + parameters.particle.diameter_m
    below = _share_below(capacity, capacity.rim_height_m - freeboard_m)
    share = max(below * capacity.n_level / max(capacity.n_candies, 1.0), _SHALLOW)
    return max(int(share * sure_candies(capacity, parameters)), 1)


def _share_below(capacity: Capacity, height_m: float) -> float:
    """Share of the hollow's volume below a height above its floor; zero without a hollow."""
    if capacity.rim_height_m <= 0:
        return 0.0
    below_ml = np.interp(height_m, capacity.heights_m, capacity.volumes_ml)
    return float(below_ml / capacity.volumes_ml[-1])


def _mouth_radius_m(capacity: Capacity) -> float:
    """Radius of the circle as large as the mouth."""
    if capacity.rim_height_m <= 0:
        return 0.0
    upper_m = _MOUTH_SHARE * capacity.rim_height_m
    upper_ml = (1 - _share_below(capacity, capacity.rim_height_m - upper_m)) * float(capacity.volumes_ml[-1])
    return sqrt(upper_ml * 1e-6 / upper_m / pi)
