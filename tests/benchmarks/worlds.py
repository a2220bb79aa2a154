"""The ground-truth worlds on cases with a known answer, and against each other.

Usage: python -m tests.benchmarks.worlds [--quick]
Of each world: bounce, sliding, rolling, a pyramid of balls, a heap, the energy of candies that come to rest,
and thin walls. Then pours that were misaimed on purpose, with the same candies and contacts in both engines
(`--quick`: two each).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import cos, degrees, radians, sin

import numpy as np

from app.operations.evaluation.ground_truth import ideal_path, pour_once
from app.operations.evaluation.placed_object import PlacedObject, place_object
from core.geometry import FloatArray, rotation_y
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import RunHere
from hardware.simulation.objects import boxed, builtin_object
from hardware.simulation.pour_outcome.bodies import GRAVITY_M_S2, Bodies, PlatformBox
from hardware.simulation.pour_outcome.candies import thickness_m
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS
from tests.hardware.simulation.pour_outcome.paths import CUP
from tests.hardware.simulation.pour_outcome.probes import UPRIGHT, follow, framed_pyramid

TABLE_M = 0.015
PLATFORM = PlatformBox((-0.26, -0.53), (0.14, -0.17), 0.08)
RAISED_M = np.array([-0.06, -0.35, 0.5])
SLAB = boxed([(0.8, 0.4, -0.02), (0.8, 0.4, 0.0)], 0.005)
DISH_M, DISH_DEPTH_M = 0.09, 0.012
DISH = boxed(
    [
        (DISH_M + 0.01, DISH_M + 0.01, -0.004),
        (DISH_M + 0.01, DISH_M + 0.01, DISH_DEPTH_M),
        (DISH_M, DISH_M, DISH_DEPTH_M),
        (DISH_M, DISH_M, 0.0),
    ],
    0.004,
)
DROPS_M = np.linspace(0.09, 0.11, 6)
SLOPE_RAD = radians(30)
ROLLING_RAD = radians(8)
WALL_M, THROW_M_S = 0.002, 2.0
MISAIMED = {"mug": 0.05, "glass": 0.05, "plate": 0.08, "bowl": 0.085}
"""How far beside the middle of each object its pour goes, in m."""
ENGINES = ("bullet", "mujoco")


def let_go(
    world: OutcomeSettings,
    mesh: TriangleMesh,
    starts_m: FloatArray,
    quaternion: FloatArray,
    duration_s: float,
) -> FloatArray:
    """Return the centres (K, N, 3) of candies let go at (N, 3), at each step."""
    bodies = Bodies(mesh, CUP, TABLE_M, PLATFORM)
    return follow(bodies, world.model_copy(update={"seed": 1}), starts_m, quaternion, duration_s)


def bounce(world: OutcomeSettings) -> float:
    """Return the share of its speed that a candy keeps when it falls flat onto the object (of six)."""
    half_m = thickness_m(world) / 2
    starts = RAISED_M + np.column_stack([0.05 * np.arange(-3, 3), np.full(6, 0.02), half_m + DROPS_M])
    heights = let_go(world, SLAB.translated(RAISED_M), starts, UPRIGHT, 0.6)[:, :, 2] - RAISED_M[2] - half_m
    landed = np.argmax(heights < 0.002, axis=0)
    highest = np.array([heights[first:, candy].max() for candy, first in enumerate(landed)])
    return float(np.sqrt(np.maximum(highest, 0.0) / DROPS_M).mean())


def _down_the_slope_m_s2(world: OutcomeSettings, slope_rad: float, above_m: float) -> float:
    turn = rotation_y(slope_rad)
    mesh = TriangleMesh(SLAB.vertices_m @ turn.T + RAISED_M, SLAB.faces)
    start = RAISED_M + turn @ np.array([-0.3, 0.0, above_m])
    quaternion = np.array([0.0, sin(slope_rad / 2), 0.0, cos(slope_rad / 2)])
    way_m = (let_go(world, mesh, start[None], quaternion, 0.4)[:, 0] - start) @ turn[:, 0]
    return 2 * float(way_m[-1]) / 0.4**2


def friction(world: OutcomeSettings) -> float:
    """Return the friction with which a tablet of this world slides down the object's slope of 30 degrees."""
    tablet = world.model_copy(update={"candy_shape": "tablet"})
    found_m_s2 = _down_the_slope_m_s2(tablet, SLOPE_RAD, world.candy_height_m / 2)
    return (GRAVITY_M_S2 * sin(SLOPE_RAD) - found_m_s2) / (GRAVITY_M_S2 * cos(SLOPE_RAD))


def rolling_arm_m(world: OutcomeSettings) -> float:
    """Return the lever with which the object slows a ball of this world on a slope of 8 degrees."""
    ball = world.model_copy(update={"candy_shape": "ball"})
    radius_m = world.candy_diameter_m / 2
    found_m_s2 = _down_the_slope_m_s2(ball, ROLLING_RAD, radius_m)
    driving_m_s2 = GRAVITY_M_S2 * sin(ROLLING_RAD) - 1.4 * found_m_s2
    return driving_m_s2 * radius_m / (GRAVITY_M_S2 * cos(ROLLING_RAD))


def _layers(world: OutcomeSettings, n_side: int, n_layers: int, low_m: float) -> FloatArray:
    pitch_m, step_m = 1.15 * world.candy_diameter_m, 1.4 * thickness_m(world)
    across = (np.arange(n_side) - (n_side - 1) / 2) * pitch_m
    x, y, k = np.meshgrid(across, across, np.arange(n_layers), indexing="ij")
    shift = 0.3 * pitch_m * (k % 2)
    return RAISED_M + np.column_stack(
        [(x + shift).ravel(), (y + shift / 2).ravel(), low_m + (k * step_m).ravel()]
    )


def heap_deg(world: OutcomeSettings) -> float:
    """Return the slope of a heap of candies in a square dish, which is full: from its rim to its top."""
    starts = _layers(world, 4, 12, 0.03)
    ends = let_go(world, DISH.translated(RAISED_M), starts, UPRIGHT, 4.0)[-1] - RAISED_M
    kept = ends[(np.abs(ends[:, :2]) < DISH_M / 2).all(axis=1) & (ends[:, 2] > 0)]
    rim_m = DISH_DEPTH_M + thickness_m(world) / 2
    return degrees(np.arctan2(np.sort(kept[:, 2])[-3:].mean() - rim_m, DISH_M / 2))


def pile_moves_m(world: OutcomeSettings) -> float:
    """Return how far a ball leaves its place in a pyramid of 30, which stands still without any friction."""
    ball = world.model_copy(update={"candy_shape": "ball"})
    frame, places_m = framed_pyramid(world.candy_diameter_m)
    starts = RAISED_M + places_m
    ends = let_go(ball, frame.translated(RAISED_M), starts, UPRIGHT, 1.5)[-1]
    return float(np.linalg.norm(ends - starts, axis=1).max())


def energy_growth(world: OutcomeSettings) -> float:
    """Return by which share of the energy lost the energy of falling candies ever grows."""
    starts = _layers(world, 3, 4, 0.02)
    centres = let_go(world, SLAB.translated(RAISED_M), starts, UPRIGHT, 2.0)
    velocities = np.diff(centres, axis=0) * world.rate_hz
    heights = (centres[1:, :, 2] + centres[:-1, :, 2]) / 2
    energy = (GRAVITY_M_S2 * heights + (velocities**2).sum(axis=2) / 2).sum(axis=1)
    lost = energy[0] - energy[-1]
    return float((energy - np.minimum.accumulate(energy)).max() / lost)


def leaked(world: OutcomeSettings) -> tuple[int, int]:
    """Return how many of how many candies pass a wall of 2 mm onto which they fall with 2 m/s."""
    sheet = boxed([(0.4, 0.4, -WALL_M), (0.4, 0.4, 0.0)], WALL_M / 4)
    starts = _layers(world, 8, 1, THROW_M_S**2 / (2 * GRAVITY_M_S2))
    ends = let_go(world, sheet.translated(RAISED_M), starts, UPRIGHT, 0.8)[-1]
    on_it = (np.abs(ends[:, :2] - RAISED_M[:2]) < 0.19).all(axis=1)
    return int((ends[on_it, 2] < RAISED_M[2] - WALL_M).sum()), len(starts)


def misaimed(world: OutcomeSettings, name: str, seeds: range) -> list[int]:
    """Return the candies spilled of pours that miss the middle of a built-in object."""
    placed: PlacedObject = place_object(builtin_object(name), "mesh", 0)
    low, high = placed.true.aabb_min_m, placed.true.aabb_max_m
    pivot_m = np.array([(low[0] + high[0]) / 2 + MISAIMED[name], (low[1] + high[1]) / 2, high[2] + 0.01])
    pouring = Parameters().pouring
    path = ideal_path(pouring, pivot_m, 0.0)
    worlds = [world.model_copy(update={"seed": seed}) for seed in seeds]
    return [pour_once(placed, path, pouring, one, 0, RunHere(), Reporter()).n_spilled for one in worlds]


def _known_answers() -> Iterator[str]:
    yield (
        "| world | bounce | is | friction | is | lever, mm | is | pile moves by, mm | heap, deg | "
        "energy grows by | leaked |"
    )
    yield "|---" * 11 + "|"
    for name, world in WORLDS.items():
        n_leaked, n = leaked(world)
        yield (
            f"| {name} | {world.wall_restitution:.2f} | {bounce(world):.2f} | {world.object_friction:.2f} | "
            f"{friction(world):.2f} | {1000 * world.rolling_arm_m:.2f} | {1000 * rolling_arm_m(world):.2f} | "
            f"{1000 * pile_moves_m(world):.2f} | {heap_deg(world):.0f} | "
            f"{100 * energy_growth(world):.2f} % | {n_leaked} of {n} |"
        )


def _both_engines(seeds: range) -> Iterator[str]:
    yield "| spilled of 60 | in Bullet | in MuJoCo |"
    yield "|---|---|---|"
    for name in MISAIMED:
        cells = []
        for engine in ENGINES:
            counts = misaimed(WORLDS["mujoco"].model_copy(update={"engine": engine}), name, seeds)
            cells.append(f"{np.mean(counts):.1f} ({min(counts)} to {max(counts)})")
        yield f"| {name}, {1000 * MISAIMED[name]:.0f} mm aside | {cells[0]} | {cells[1]} |"


if __name__ == "__main__":
    for line in _known_answers():
        print(line, flush=True)
    print()
    for line in _both_engines(range(2 if "--quick" in sys.argv else 6)):
        print(line, flush=True)
