"""Candies raining over a footprint, handful after handful."""

from __future__ import annotations

from math import ceil, sqrt

import numpy as np

from core.geometry import FloatArray
from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.stand_in import StandIn
from core.imagination.particle_shape import particle_extents_m

_APART = 1.05
"""Distance of neighbours in a handful, in diameters."""
_MOST_TRIED = 300
"""Places tried for one handful; finely spaced ones differ little."""
_FOLLOWS = 1.3
"""Distance of two handfuls when they rain fast, in heights of a candy."""
_SLOW_S = 0.1
"""Time between two handfuls when they rain slowly; it grows with the root of the candies' size."""
_RUNS_OVER = 0.4
"""It runs over when less than this share of the last candies adds up."""


class Rain:
    """Lets handfuls go above the footprint, no two particles touching."""

    def __init__(
        self,
        world: BulletWorld,
        top_m: float,
        stand_in: StandIn,
        places_m: FloatArray,
        generator: np.random.Generator,
        speed_m_s: float,
    ) -> None:
        extents_m = particle_extents_m(stand_in.particle)
        self._world, self._places_m, self._generator = world, places_m, generator
        self._apart_m = _APART * float(extents_m[0])
        self._height_m = top_m + float(extents_m[0])
        self._velocity = np.array([0.0, 0.0, -speed_m_s, 0.0, 0.0, 0.0])
        rate_hz = stand_in.solver.rate_hz
        self.fast_steps = ceil(_FOLLOWS * float(extents_m[2]) / speed_m_s * rate_hz)
        self.slow_steps = max(self.fast_steps, ceil(_SLOW_S * sqrt(stand_in.scale) * rate_hz))

    def handful(self) -> None:
        """Let go one layer."""
        chosen = np.empty((0, 2))
        for place in self._places_m[self._generator.permutation(len(self._places_m))[:_MOST_TRIED]]:
            if (np.hypot(*(chosen - place).T) >= self._apart_m).all():
                chosen = np.vstack([chosen, place])
        for x, y in chosen.tolist():
            self._world.add_particle(np.array([x, y, self._height_m, 0, 0, 0, 1]), self._velocity)


def runs_over(seen: list[tuple[int, float]], window: float) -> bool:
    """Whether the last `window` candies hardly added up, given how many rained and how many were inside."""
    poured, inside = seen[-1]
    before = [entry for entry in seen if entry[0] <= poured - window]
    return bool(before) and inside - before[-1][1] < _RUNS_OVER * (poured - before[-1][0])
