from collections.abc import Callable

import numpy as np
import pytest

from core.mesh import TriangleMesh
from core.progress import Reporter
from core.workers import WorkerPool
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.bodies import PlatformBox
from hardware.simulation.pour_outcome.driven_path import DrivenPath
from hardware.simulation.pour_outcome.outcome import TableOutcome, simulate_outcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from tests.hardware.simulation.pour_outcome.paths import CUP

TABLE_M = 0.015
PLATFORM = PlatformBox((-0.26, -0.53), (0.14, -0.17), 0.08)
EXACT = {"object_error_m": 0.0, "object_error_rad": 0.0, "cup_slip_m": 0.0, "cup_slip_rad": 0.0}

Simulate = Callable[..., TableOutcome]


@pytest.fixture(scope="session")
def pool():
    with WorkerPool(2) as workers:
        yield workers


@pytest.fixture(scope="session")
def simulate(pool: WorkerPool) -> Simulate:
    """Drive a path without errors of the set-up, unless the settings say otherwise."""

    def run(
        mesh: TriangleMesh,
        path: DrivenPath,
        pool: WorkerPool = pool,
        reporter: Reporter | None = None,
        **settings: object,
    ) -> TableOutcome:
        chosen = OutcomeSettings(**EXACT | settings)
        return simulate_outcome(mesh, path, CUP, TABLE_M, PLATFORM, chosen, pool, reporter or Reporter())

    return run


@pytest.fixture(scope="session")
def bowl() -> TriangleMesh:
    return on_platform(builtin_object("bowl"))


def on_platform(mesh: TriangleMesh) -> TriangleMesh:
    """Upright in the platform's middle."""
    return mesh.translated(np.array([-0.06, -0.35, PLATFORM.height_m]))


def pivot_above(mesh: TriangleMesh, beside_m: float = 0.0) -> np.ndarray:
    """10 mm above the object's top, over its middle or beside it."""
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    return np.array([middle[0] + beside_m, middle[1], mesh.aabb_max_m[2] + 0.01])
