"""Small experiments with a few candies in the simulated table's world; they run in a worker."""

import numpy as np

from core.geometry import FloatArray
from hardware.simulation.pour_outcome.candies import Candies
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.table_world import Bodies, TableWorld

AWAY_M = np.array([5.0, 5.0, 1.0])
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
    with TableWorld(bodies, settings) as world:
        world.add_candies(candies, np.eye(4), UPRIGHT)
        for _ in range(round(duration_s * settings.rate_hz)):
            centres.append(world.poses()[:, :3])
            world.drive_cup(AWAY_M, UPRIGHT, np.zeros(3), np.zeros(3))
            world.step()
    return np.array(centres)
