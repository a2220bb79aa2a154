"""An object as the physics sees it, and which particles lie inside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.body import BodyFile
from core.imagination.hollow_map import HollowMap
from core.imagination.particle_shape import half_heights_m
from core.mesh import TriangleMesh
from core.parameters.bodies import ParticleParameters


@dataclass(frozen=True)
class ObjectAtRest:
    """What the physics needs to know of an object.

    Attributes:
        body: its shape.
        aabb_m: (2, 3).
        center_of_mass_m: (3,).
        hollows: where candies cannot leave it by themselves; none if nobody asked.
    """

    body: BodyFile
    aabb_m: FloatArray
    center_of_mass_m: FloatArray
    hollows: HollowMap | None = None

    @classmethod
    def of(cls, surface: TriangleMesh, body: BodyFile, aabb_margin_m: float) -> ObjectAtRest:
        """Gather it from the object's surface."""
        aabb_m = np.array([surface.aabb_min_m - aabb_margin_m, surface.aabb_max_m + aabb_margin_m])
        return cls(body, aabb_m, surface.center_of_mass_m)


def inside_aabb(positions_m: FloatArray, aabb_m: FloatArray) -> BoolArray:
    """Return (n,) whether each of (n, 3) centres lies inside; absent particles (NaN) do not."""
    with np.errstate(invalid="ignore"):
        inside: BoolArray = ((positions_m > aabb_m[0]) & (positions_m < aabb_m[1])).all(axis=1)
    return inside


def has_room_above(poses: FloatArray, aabb_m: FloatArray, particle: ParticleParameters) -> BoolArray:
    """Return (n,) whether another particle on top of each at (n, 7) would have its centre inside; NaN: no.

    A hollow that one layer fills to the brim, such as a can's rim, holds candies but takes no pour.
    """
    with np.errstate(invalid="ignore"):
        above_m = poses[:, 2] + 2 * half_heights_m(particle, poses[:, 3:])
        has_room: BoolArray = above_m < aabb_m[1, 2]
    return has_room
