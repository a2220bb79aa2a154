"""How far a particle may move in one computation before it slips through a wall.

Usage: python -m tests.benchmarks.tunnelling
Throws 768 particles at each speed onto a sheet of triangles, level and at 30 degrees, and counts those that
slip through, with steps cut as finely as in the program, more finely and more coarsely; "uncut" cuts none.
The rows "not swept" have no continuous collision detection.
"""

from __future__ import annotations

from itertools import product
from math import inf, radians
from time import process_time
from typing import Any

from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.stand_in import StandIn, ball_of, candy_itself
from core.parameters import Parameters
from tests.core.imagination.falling import thrown

SPEEDS_M_S = (0.3, 0.5, 0.8, 1.2, 1.6, 2.0, 3.0)
TILTS_RAD = (0.0, radians(30))
SEEDS = range(6)
COARSER = (0.5, 1.0, 2.0, inf)
BALL_SCALES = (1.5, 2.5)


def coarser_world(factor: float, is_swept: bool) -> type[BulletWorld]:
    """Return a world in which a particle may move `factor` times as far as in the program's."""

    class CoarserWorld(BulletWorld):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            self._safe_m_s *= factor
            if not is_swept:
                del self._dynamics["ccdSweptSphereRadius"]

    return CoarserWorld


def slipped_at(speed_m_s: float, particles: StandIn, world_type: type[BulletWorld]) -> str:
    """Return how many of how many particles slipped through."""
    settings = particles.solver, particles.particle, particles.contact
    counts = [
        thrown(world_type, *settings, speed_m_s, tilt_rad, seed) for tilt_rad in TILTS_RAD for seed in SEEDS
    ]
    return f"{sum(slipped for _, slipped in counts)}/{sum(n for n, _ in counts)}"


def main() -> None:
    """Print one row for each particle and each coarseness."""
    parameters = Parameters()
    kinds = {"candy": candy_itself(parameters)}
    kinds |= {f"ball of {scale} candies across": ball_of(parameters, scale) for scale in BALL_SCALES}
    print(
        "particle; moves at most, times the program's; " + "; ".join(f"{v} m/s" for v in SPEEDS_M_S),
        flush=True,
    )
    for name, particles in kinds.items():
        for factor, is_swept in product(COARSER, (True, False)):
            started = process_time()
            world_type = coarser_world(factor, is_swept)
            row = [slipped_at(speed, particles, world_type) for speed in SPEEDS_M_S]
            how = ("uncut" if factor == inf else f"{factor}") + ("" if is_swept else ", not swept")
            print(f"{name}; {how}; {'; '.join(row)}; {process_time() - started:.1f} s", flush=True)


if __name__ == "__main__":
    main()
