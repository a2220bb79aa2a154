from math import radians

import numpy as np
import pytest

from core.collision import CollisionModel, from_parts
from core.mesh import TriangleMesh
from core.parameters import Parameters, apply_settings
from core.workers import WorkerPool

BOX_FACES = np.array(
    [
        [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
        [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7],
    ]
)  # fmt: skip


def box(low, high) -> TriangleMesh:
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return TriangleMesh(np.array([(x, y, z) for z in (z0, z1) for x, y in corners]), BOX_FACES)


@pytest.fixture(scope="session")
def dish() -> CollisionModel:
    """An open dish, 100 x 60 x 40 mm outside, with walls of 5 mm, away from the origin."""
    x, y, z, wall = 0.10, 0.06, 0.04, 0.005
    parts = (
        box((0, 0, 0), (x, y, wall)),
        box((0, 0, 0), (wall, y, z)),
        box((x - wall, 0, 0), (x, y, z)),
        box((0, 0, 0), (x, wall, z)),
        box((0, y - wall, 0), (x, y, z)),
    )
    return from_parts(tuple(part.translated(np.array([0.3, -0.2, 0.1])) for part in parts))


@pytest.fixture(scope="session")
def block() -> CollisionModel:
    return from_parts((box((0, 0, 0), (0.08, 0.06, 0.05)),))


@pytest.fixture(scope="session")
def quick() -> Parameters:
    """Fewer candies, and small ones, for which the dish is large; two packings."""
    return apply_settings(
        Parameters(),
        {
            "particle.shape": "cylinder",
            "particle.diameter_m": 0.007,
            "particle.height_m": 0.0028,
            "particle.mass_kg": 0.0003,
            "solver.substeps": 2,
            "containability.n_max": 80,
            "containability.rotation_rad": radians(3),
            "containability.counted": "centre",
            "containability.omega_threshold": 0.0,
            "containability.contact.lateral_friction": 0.005,
            "containability.contact.spinning_friction": 0.5,
            "containability.contact.rolling_friction": 0.5,
            "pouring.n_pour": 20,
            "pouring.n_packings": 2,
            "containability.verdict": "omega",
            "risk.n_tries": 4,
        },
    )


@pytest.fixture(scope="session")
def pool():
    with WorkerPool(2) as workers:
        yield workers
