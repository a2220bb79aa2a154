"""Particles thrown at a single sheet of triangles, the thinnest wall there is: how many slip through."""

import numpy as np
from scipy.spatial.transform import Rotation

from core.imagination.body import body_files
from core.imagination.bullet_world import BulletWorld
from core.mesh import TriangleMesh
from core.parameters.bodies import ContactParameters, ParticleParameters, SolverParameters

SIDE_M, SQUARES = 0.3, 24
PER_SIDE = 8
FALL_S = 0.3


def thrown(
    world_type: type[BulletWorld],
    solver: SolverParameters,
    particle: ParticleParameters,
    contact: ContactParameters,
    speed_m_s: float,
    tilt_rad: float,
    seed: int,
) -> tuple[int, int]:
    """Return how many particles were thrown down, and how many were seen below the sheet."""
    generator = np.random.default_rng(seed)
    region_m = np.array([[-SIDE_M / 2, -SIDE_M / 2, -0.1], [SIDE_M / 2, SIDE_M / 2, 0.1]])
    slope = np.tan(tilt_rad)
    clear_m = particle.diameter_m + 0.01
    with (
        body_files(sheet=((_sheet(tilt_rad),), True)) as files,
        world_type(solver, particle, contact, region_m) as world,
    ):
        world.add_fixed_body(files["sheet"])
        axis = np.linspace(-SIDE_M / 3, SIDE_M / 3, PER_SIDE)
        for x in axis:
            for y in axis:
                quaternion = Rotation.random(random_state=int(generator.integers(1 << 31))).as_quat()
                height_m = slope * x + clear_m + generator.uniform(0, 0.02)
                spin = generator.normal(0, 10, 3)
                world.add_particle(
                    np.array([x, y, height_m, *quaternion]), np.array([0, 0, -speed_m_s, *spin])
                )
        slipped = np.zeros(PER_SIDE**2, dtype=bool)
        for _ in range(round(FALL_S * solver.rate_hz)):
            world.step()
            positions = world.poses()[:, :3]
            above_sheet = (np.abs(positions[:, :2]) < 0.9 * SIDE_M / 2 * np.cos(tilt_rad)).all(axis=1)
            slipped |= above_sheet & (positions[:, 2] - slope * positions[:, 0] < -0.002)
    return len(slipped), int(slipped.sum())


def _sheet(tilt_rad: float) -> TriangleMesh:
    axis = np.linspace(-SIDE_M / 2, SIDE_M / 2, SQUARES + 1)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    flat = np.column_stack([x.ravel(), y.ravel(), np.tan(tilt_rad) * x.ravel()])
    i, j = np.meshgrid(range(SQUARES), range(SQUARES), indexing="ij")
    corner = (i * (SQUARES + 1) + j).ravel()
    over = corner + SQUARES + 1
    lower = np.column_stack([corner, over, corner + 1])
    upper = np.column_stack([over, over + 1, corner + 1])
    return TriangleMesh(flat, np.vstack([lower, upper]))
