"""The world does what its settings say, in the units they say it in."""

from collections.abc import Callable
from math import cos, radians, sin

import numpy as np
import pytest

from core.geometry import FloatArray, rotation_y
from core.mesh import TriangleMesh
from core.progress import Reporter
from core.workers import Task, WorkerPool
from hardware.simulation.objects import boxed
from hardware.simulation.pour_outcome.bodies import GRAVITY_M_S2, Bodies
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS
from tests.hardware.simulation.pour_outcome.conftest import PLATFORM, TABLE_M
from tests.hardware.simulation.pour_outcome.paths import CUP
from tests.hardware.simulation.pour_outcome.probes import UPRIGHT, follow, framed_pyramid

Let = Callable[..., FloatArray]
SLAB = boxed([(0.8, 0.4, -0.02), (0.8, 0.4, 0.0)], 0.005)
"""Its top at height 0, before it is turned and raised."""
HALF_M = OutcomeSettings().candy_height_m / 2
RAISED_M = np.array([-0.06, -0.35, 0.5])


@pytest.fixture(scope="module", params=["bullet", "mujoco"])
def let_go(pool: WorkerPool, request: pytest.FixtureRequest) -> Let:
    engine = request.param

    def run(
        mesh: TriangleMesh,
        positions_m: FloatArray,
        quaternion: FloatArray,
        duration_s: float,
        **values: object,
    ) -> FloatArray:
        settings = OutcomeSettings(engine=engine, **values)
        bodies = Bodies(mesh, CUP, TABLE_M, PLATFORM)
        task = Task(follow, (bodies, settings, positions_m, quaternion, duration_s))
        return pool.run([task], "probe", Reporter())[0]

    return run


@pytest.mark.parametrize("friction", [0.1, 0.3])
@pytest.mark.parametrize("candy_friction", [0.1, 0.8])
def test_a_tablet_slides_down_a_slope_as_coulomb_says(
    let_go: Let, friction: float, candy_friction: float
) -> None:
    slope = radians(30)
    turn = rotation_y(slope)
    mesh = TriangleMesh(SLAB.vertices_m @ turn.T + RAISED_M, SLAB.faces)
    start = RAISED_M + turn @ np.array([-0.3, 0.0, HALF_M])
    quaternion = np.array([0.0, sin(slope / 2), 0.0, cos(slope / 2)])
    way_m = let_go(
        mesh, start[None], quaternion, 0.4, candy_shape="tablet", object_friction=friction,
        candy_friction=candy_friction,
    )  # fmt: skip
    slid_m = (way_m[-1, 0] - start) @ turn[:, 0]
    acceleration = GRAVITY_M_S2 * (sin(slope) - friction * cos(slope))
    assert slid_m == pytest.approx(acceleration * 0.4**2 / 2, rel=0.1)


@pytest.mark.parametrize("restitution", [0.2, 0.6])
def test_candies_bounce_as_high_as_their_restitution_says(let_go: Let, restitution: float) -> None:
    """On the average over drops: where in a step a candy lands makes a difference."""
    drops_m = np.linspace(0.09, 0.11, 6)
    starts = RAISED_M + np.column_stack([0.05 * np.arange(-3, 3) + 0.01, np.full(6, 0.02), HALF_M + drops_m])
    heights_m = let_go(
        SLAB.translated(RAISED_M), starts, UPRIGHT, 0.6, wall_restitution=restitution, candy_restitution=0.5
    )[:, :, 2] - RAISED_M[2] - HALF_M  # fmt: skip
    landed = np.argmax(heights_m < 0.002, axis=0)
    highest_m = np.array([heights_m[first:, candy].max() for candy, first in enumerate(landed)])
    assert np.sqrt(np.maximum(highest_m, 0) / drops_m).mean() == pytest.approx(restitution, abs=0.06)


def test_a_pyramid_of_balls_in_a_frame_stands_still(let_go: Let) -> None:
    """The frame carries its thrust: it needs no friction."""
    frame, places_m = framed_pyramid(0.013)
    starts = RAISED_M + places_m
    ends = let_go(
        frame.translated(RAISED_M), starts, UPRIGHT, 1.0, candy_shape="ball", candy_diameter_m=0.013
    )[-1]  # fmt: skip
    assert np.linalg.norm(ends - starts, axis=1).max() < 0.001


def test_candies_rest_at_their_own_height_on_object_platform_and_table(let_go: Let) -> None:
    mesh = boxed([(0.06, 0.06, 0.0), (0.06, 0.06, 0.03)], 0.003).translated(
        np.array([-0.06, -0.35, PLATFORM.height_m])
    )
    floors_m = np.array([PLATFORM.height_m + 0.03, PLATFORM.height_m, TABLE_M])
    starts = np.array([[-0.05, -0.34, 0], [0.05, -0.3, 0], [0.3, 0.1, 0]])
    starts[:, 2] = floors_m + 0.02
    way_m = let_go(mesh, starts, UPRIGHT, 2.0)
    assert way_m[-1, :, 2] - floors_m == pytest.approx(HALF_M, abs=1e-4)


@pytest.mark.parametrize("world", WORLDS)
def test_candies_that_came_to_rest_in_a_heap_stay_at_rest(pool: WorkerPool, world: str) -> None:
    """A contact that is found too deep throws them."""
    box = boxed([(0.04, 0.04, 0.0), (0.04, 0.04, 0.08)], 0.003).translated(RAISED_M)
    places_m = np.stack(np.meshgrid(*2 * [[-0.014, 0.0, 0.014]], 0.01 + 0.01 * np.arange(6)), axis=-1)
    bodies = Bodies(box, CUP, TABLE_M, PLATFORM)
    task = Task(follow, (bodies, WORLDS[world], RAISED_M + places_m.reshape(-1, 3), UPRIGHT, 3.0))
    way_m = pool.run([task], "probe", Reporter())[0]
    steps_m = np.linalg.norm(np.diff(way_m, axis=0), axis=2)
    resting_m_s = WORLDS[world].rate_hz * steps_m[len(steps_m) // 2 :]
    assert resting_m_s.max() < 0.1
