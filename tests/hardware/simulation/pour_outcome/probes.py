"""Small experiments with a few candies in the simulated table's world; they run in a worker."""

from math import sqrt

import numpy as np

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from hardware.simulation.objects import boxed
from hardware.simulation.pour_outcome.bodies import Bodies
from hardware.simulation.pour_outcome.candies import Candies
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.table import open_table

AWAY_M = np.array([5.0, 5.0, 1.0])
_PYRAMID_SIDE, _GAP_M = 4, 0.0001
UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def follow(
    bodies: Bodies,
    settings: OutcomeSettings,
    positions_m: FloatArray,
    quaternion: FloatArray,
    duration_s: float,
) -> FloatArray:
    """Let candies go at (N, 3) and return their centres (K, N, 3) at each step; the cup stands far away."""
    n = len(positions_m)
    candies = Candies(np.ones(n), positions_m, np.tile(quaternion, (n, 1)))
    centres = []
    with open_table(bodies, settings) as world:
        world.add_candies(candies)
        for _ in range(round(duration_s * settings.rate_hz)):
            centres.append(world.poses()[:, :3])
            world.drive_cup(AWAY_M, UPRIGHT, np.zeros(3), np.zeros(3))
            world.step()
    return np.array(centres)


def framed_pyramid(diameter_m: float) -> tuple[TriangleMesh, FloatArray]:
    """A square frame with a floor at height 0, and the centres (30, 3) of the balls piled up in it."""
    inner_m, rim_m = _PYRAMID_SIDE * diameter_m + 2 * _GAP_M, diameter_m
    profile = [(1.5 * inner_m, -0.004), (1.5 * inner_m, rim_m), (inner_m, rim_m), (inner_m, 0.0)]
    centres_m = [
        (
            (x - (n - 1) / 2) * diameter_m,
            (y - (n - 1) / 2) * diameter_m,
            diameter_m / 2 + (_PYRAMID_SIDE - n) * diameter_m / sqrt(2) + _GAP_M,
        )
        for n in range(_PYRAMID_SIDE, 0, -1)
        for x in range(n)
        for y in range(n)
    ]
    return boxed([(width_m, width_m, height_m) for width_m, height_m in profile], 0.004), np.array(centres_m)
