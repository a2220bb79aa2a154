"""Objects that the fixed views do not suit, and how deep their scan is hollow."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from hardware.simulation.objects import boxed, turned
from hardware.simulation.world import World

SEEN_M = 0.004
"""How far a side that the views see may be off."""
INSIDE_M = 0.004
SHARES = (np.zeros(3), *(sign * 0.3 * np.eye(3)[axis] for axis in (0, 1) for sign in (-1, 1)))


def open_box(length_m: float, width_m: float, height_m: float, wall_m: float = 0.006) -> TriangleMesh:
    inner = (length_m - 2 * wall_m, width_m - 2 * wall_m)
    profile = [(length_m, width_m, 0.0), (length_m, width_m, height_m), (*inner, height_m), (*inner, wall_m)]
    return boxed(profile, 0.01)


def cylinder(radius_m: float, height_m: float, wall_m: float = 0.005) -> TriangleMesh:
    inner_m = radius_m - wall_m
    return turned([(radius_m, 0.0), (radius_m, height_m), (inner_m, height_m), (inner_m, wall_m)])


def floor_heights_m(surface: TriangleMesh, true: TriangleMesh) -> FloatArray:
    """Where lines down through the mouth, at its middle and halfway to its sides, meet a surface first."""
    world = World(surface, np.array([0.0, 0.0, -1.0]))
    middle, size = (true.aabb_min_m + true.aabb_max_m) / 2, true.extents_m
    above = [np.array([*(middle + share * size)[:2], 1.0]) for share in SHARES]
    down = np.array([[[0.0, 0.0, -1.0]]])
    return np.array([world.cast(origin, down).points_m[0, 0, 2] for origin in above])
