"""Looking after the candies: how often, and which are still inside."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.imagination.bullet_world import BulletWorld
from core.imagination.containability import inside_aabb

LOOK_STEPS = 12
"""Steps between two looks at whether the candies rest."""


def keep_inside(world: BulletWorld, box_m: FloatArray) -> int:
    """Take out the candies whose centre is outside the box (2, 3); return how many are left."""
    inside = inside_aabb(world.poses()[:, :3], box_m)
    for index in np.flatnonzero(~inside).tolist():
        if world.particle_ids[index] is not None:
            world.remove_particle(index)
    return int(inside.sum())
