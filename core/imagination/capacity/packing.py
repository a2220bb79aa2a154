"""Which share of a volume candies fill in bulk, near walls and far from them.

Measured with the imagination's own physics: open cylinders and boxes filled until they ran over and
perturbed, what lies below the rim counted (`python -m tests.benchmarks.capacity --packing`). Floors and walls
keep particles away, so the share falls with their size against both, as it does for spheres in tubes.
"""

from __future__ import annotations

from dataclasses import dataclass

from core.imagination.capacity.stand_in import ball_diameter_m, particle_volume_m3
from core.parameters.imagination import ParticleParameters


@dataclass(frozen=True)
class Fit:
    """Share far from everything, and what floor and walls take away, by size times area over volume."""

    free: float
    floor: float
    side: float


BALLS = Fit(0.582, 0.049, 0.0)
CANDIES = Fit(0.600, 0.080, 0.020)
_MOST_FLOOR, _MOST_SIDE = 0.9, 1.4
"""Beyond what was measured the last counts: there nothing is bulk any more."""


@dataclass(frozen=True)
class Surroundings:
    """What a bulk of candies lies against: its volume, and the areas of floor and walls that it touches."""

    volume_m3: float
    floor_m2: float
    side_m2: float


NOWHERE = Surroundings(1.0, 0.0, 0.0)
"""Far from everything."""


def packing_fraction(particle: ParticleParameters, around: Surroundings) -> float:
    """Return the share of a volume that particles fill in bulk."""
    fit = BALLS if particle.shape == "sphere" else CANDIES
    per_volume = ball_diameter_m(particle) / around.volume_m3
    floor = min(per_volume * around.floor_m2, _MOST_FLOOR)
    return fit.free - fit.floor * floor - fit.side * min(per_volume * around.side_m2, _MOST_SIDE)


def bulk_ml(particle: ParticleParameters, around: Surroundings) -> float:
    """Return what a particle takes up in bulk, in ml."""
    return particle_volume_m3(particle) * 1e6 / packing_fraction(particle, around)
