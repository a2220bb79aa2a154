from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from core.geometry import FloatArray, make_pose, rotation_x, rotation_y
from core.imagination.recording import Recorder, Recording
from core.imagination.rendering.shapes import cup_surface
from core.imagination.results import Containability, Footprint, PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import Parameters

N_CANDIES = 20
LOST = 5
FRAME_S = 1 / 24


@dataclass(frozen=True)
class Story:
    """An imagination made by hand: a box, candies that come to rest on it, some that miss it."""

    surface: TriangleMesh
    cup: TriangleMesh
    parameters: Parameters
    containability: Containability
    grid: PourGrid
    choice: PourChoice


def box_mesh(low_m: FloatArray, high_m: FloatArray) -> TriangleMesh:
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = [[a, b, c] for a, b, c, _ in quads] + [[a, c, d] for a, _, c, d in quads]
    return TriangleMesh(low_m + corners * (high_m - low_m), np.array(faces, dtype=np.int64))


def falling(aabb_m: FloatArray, seconds: float, T_world_body: FloatArray) -> Recording:
    """Candies fall onto the box; the first `LOST` stand beside it and are taken out below its floor."""
    recorder = Recorder(N_CANDIES)
    for frame in range(round(seconds / FRAME_S) + 1):
        time_s = frame * FRAME_S
        heights = np.full(N_CANDIES, aabb_m[1, 2] + 0.05 - 4.9 * time_s**2)
        poses = np.zeros((N_CANDIES, 7))
        poses[:, 6] = 1
        poses[:, :2] = np.linspace(aabb_m[0, :2] + 0.01, aabb_m[1, :2] - 0.01, N_CANDIES)
        poses[:LOST, 0] = aabb_m[0, 0] - 0.02
        heights[LOST:] = np.maximum(heights[LOST:], aabb_m[1, 2] - 0.0002)
        poses[:, 2] = heights
        poses[heights < aabb_m[0, 2] - 0.02] = np.nan
        recorder.add(time_s, poses, T_world_body)
    return recorder.recording()


@pytest.fixture(scope="session")
def story() -> Story:
    surface = box_mesh(np.array([0.3, -0.4, 0.1]), np.array([0.42, -0.3, 0.15]))
    aabb = np.array([surface.aabb_min_m, surface.aabb_max_m])
    parameters = Parameters()
    drop = falling(aabb, 1.5, np.eye(4))
    retained = np.arange(N_CANDIES) >= LOST
    starts = drop.positions_m[0].astype(float)
    footprint = Footprint.of(starts[retained, :2], float(aabb[1, 2]) + 0.01)
    containability = Containability(starts, retained, aabb, footprint, drop, omega_threshold=0.0)

    middle = (aabb[0] + aabb[1]) / 2
    T_world_cup = make_pose(rotation_x(0.3) @ rotation_y(2.0), middle + np.array([0.1, 0, 0.12]))
    pour = falling(aabb, 0.5, T_world_cup)
    thetas, indents = np.arange(8) * np.pi / 4, np.array([0.01, 0.02, 0.03])
    n_in = np.full((8, 3, 1), N_CANDIES - LOST)
    pivots = np.tile(middle, (8, 3, 1))
    grid = PourGrid(
        N_CANDIES, n_in, N_CANDIES - n_in, thetas, indents, pivots, tuple(tuple([pour] * 3) for _ in range(8))
    )
    choice = PourChoice(2, 1, float(thetas[2]), middle, T_world_cup)
    return Story(surface, cup_surface(parameters.pouring.cup), parameters, containability, grid, choice)
