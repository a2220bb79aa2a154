"""The candies' shapes (Sec. IV-C): all that the program knows of each, in one table."""

from __future__ import annotations

from math import pi
from typing import Any, ClassVar

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray, ellipsoid_inertia_kg_m2
from core.imagination.engine import bullet
from core.parameters.bodies import ParticleParameters

Outline = tuple[tuple[float, float], ...]
"""(radius, height) in half diameters and half heights, from the top to the bottom, for drawing."""
_BEVEL = 0.15
_ROUND: Outline = tuple((float(np.sin(a)), float(np.cos(a))) for a in np.pi * np.arange(1, 6) / 6)
_SAFE_MOVE_M = 0.0009
"""Bullet sees a triangle from 1 mm away: a candy that moves on by more between two looks slips through it."""
_SAFE_SKINS = 2.0
"""How far a candy may move on, in thicknesses of its skin: what is not in the skin is met by the sweep."""
_SWEPT_SHARE = 0.5
"""Radius of the ball that is swept along a fast particle's way, relative to half the particle's height.

A larger one would stop the particle before it touches, and take its bounce.
"""


class ParticleShape:
    """One shape; its methods take the sizes from the parameters, lengths in m."""

    outline: ClassVar[Outline]
    fills_as_ball: ClassVar[bool] = False
    """Whether it packs, and counts as partly below a level, like a ball (`capacity`)."""

    def height_m(self, particle: ParticleParameters) -> float:
        """Return the extent along its axis."""
        return particle.height_m

    def volume_m3(self, particle: ParticleParameters) -> float:
        """Return the volume of one particle."""
        raise NotImplementedError

    def half_heights_m(self, particle: ParticleParameters, cosine: FloatArray) -> FloatArray:
        """Return (N,) how far particles reach above their centres; `cosine` (N,) of axis against vertical."""
        raise NotImplementedError

    def skin_m(self, particle: ParticleParameters) -> float:  # noqa: ARG002
        """Return the thickness of a round skin around its hull (Bullet's collision margin); 0: none."""
        return 0.0

    def safe_move_m(self, particle: ParticleParameters) -> float:
        """Return how far it may move in one computation without slipping through a wall (decision 0047)."""
        return max(_SAFE_MOVE_M, _SAFE_SKINS * self.skin_m(particle))

    def swept_radius_m(self, particle: ParticleParameters) -> float:
        """Return the radius of the ball whose way continuous collision detection follows (decision 0047)."""
        return _SWEPT_SHARE * self.height_m(particle) / 2

    def collision(self, particle: ParticleParameters) -> dict[str, Any]:
        """Return the arguments of `createCollisionShape`; only workers ask."""
        raise NotImplementedError

    def dynamics(self, particle: ParticleParameters) -> dict[str, Any]:  # noqa: ARG002
        """Return the arguments of `changeDynamics` besides the contact."""
        return {}


class _Cylinder(ParticleShape):
    """What the released code's hull acts as."""

    outline = ((1 - _BEVEL, 1.0), (1.0, 1 - 2 * _BEVEL), (1.0, 2 * _BEVEL - 1), (1 - _BEVEL, -1.0))

    def volume_m3(self, particle: ParticleParameters) -> float:
        return pi / 4 * particle.diameter_m**2 * particle.height_m

    def half_heights_m(self, particle: ParticleParameters, cosine: FloatArray) -> FloatArray:
        sine = np.sqrt(1 - cosine * cosine)
        heights: FloatArray = particle.diameter_m / 2 * sine + particle.height_m / 2 * cosine
        return heights

    def collision(self, particle: ParticleParameters) -> dict[str, Any]:
        size = {"radius": particle.diameter_m / 2, "height": particle.height_m}
        return {"shapeType": bullet.GEOM_CYLINDER, **size}


class _Sphere(ParticleShape):
    """A ball; `height_m` does not matter."""

    outline = _ROUND
    fills_as_ball = True

    def height_m(self, particle: ParticleParameters) -> float:
        return particle.diameter_m

    def volume_m3(self, particle: ParticleParameters) -> float:
        return pi / 6 * particle.diameter_m**3

    def half_heights_m(self, particle: ParticleParameters, cosine: FloatArray) -> FloatArray:
        return np.full(len(cosine), particle.diameter_m / 2)

    def safe_move_m(self, particle: ParticleParameters) -> float:
        return max(_SAFE_MOVE_M, particle.diameter_m / 2)

    def collision(self, particle: ParticleParameters) -> dict[str, Any]:
        return {"shapeType": bullet.GEOM_SPHERE, "radius": particle.diameter_m / 2}


class _Ellipsoid(ParticleShape):
    """A lentil: a convex hull in a round skin.

    While only skins touch, contacts are quick to find and exact, and a fast candy is seen by a wall before it
    is in it: the same pours take half the time and fewer parts of a step. The hull's vertices are those with
    which hull and skin come closest to the ellipsoid, 0.15 mm at most for the default candy (decision 0047).
    """

    outline = _ROUND
    _skin_share = 0.7
    _rim_sides = 12
    _face_height, _face_sides = 0.8, 4

    def volume_m3(self, particle: ParticleParameters) -> float:
        return pi / 6 * particle.diameter_m**2 * particle.height_m

    def half_heights_m(self, particle: ParticleParameters, cosine: FloatArray) -> FloatArray:
        sine = np.sqrt(1 - cosine * cosine)
        return np.hypot(particle.diameter_m / 2 * sine, particle.height_m / 2 * cosine)

    def skin_m(self, particle: ParticleParameters) -> float:
        return self._skin_share * min(particle.diameter_m, particle.height_m) / 2

    def collision(self, particle: ParticleParameters) -> dict[str, Any]:
        skin_m = 2 * self.skin_m(particle)
        hull = self.hull_m(particle.diameter_m - skin_m, particle.height_m - skin_m)
        return {"shapeType": bullet.GEOM_MESH, "vertices": hull.tolist()}

    def dynamics(self, particle: ParticleParameters) -> dict[str, Any]:
        inertia = ellipsoid_inertia_kg_m2(particle.mass_kg, particle.diameter_m, particle.height_m)
        return {
            "mass": particle.mass_kg,
            "collisionMargin": self.skin_m(particle),
            "localInertiaDiagonal": inertia.tolist(),
        }

    def hull_m(self, diameter_m: float, height_m: float) -> FloatArray:
        """Return the vertices (n, 3) of a convex hull that stands for an ellipsoid flattened along z."""
        vertices = np.vstack(
            [
                [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]],
                _ring(0.0, self._rim_sides),
                _ring(self._face_height, self._face_sides),
                _ring(-self._face_height, self._face_sides),
            ]
        )
        return vertices * [diameter_m / 2, diameter_m / 2, height_m / 2]


def _ring(height: float, sides: int) -> FloatArray:
    """Return vertices (sides, 3) of the unit sphere at a height."""
    angles = np.arange(sides) * 2 * np.pi / sides
    radius = np.sqrt(1 - height * height)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(sides, height)])


ELLIPSOID = _Ellipsoid()
SHAPES: dict[str, ParticleShape] = {"cylinder": _Cylinder(), "ellipsoid": ELLIPSOID, "sphere": _Sphere()}
"""By the word in `particle.shape`."""


def shape_of(particle: ParticleParameters) -> ParticleShape:
    """Return the shape of a particle.

    Raises:
        StageError: nobody knows that shape.
    """
    try:
        return SHAPES[particle.shape]
    except KeyError:
        known = ", ".join(SHAPES)
        raise StageError(
            f"Nothing is known of the particle shape '{particle.shape}'; known are {known}."
        ) from None


def particle_extents_m(particle: ParticleParameters) -> FloatArray:
    """Edge lengths (3,) of the AABB of a particle lying flat."""
    return np.array([particle.diameter_m, particle.diameter_m, shape_of(particle).height_m(particle)])


def particle_volume_m3(particle: ParticleParameters) -> float:
    """Volume of one particle."""
    return shape_of(particle).volume_m3(particle)


def half_heights_m(particle: ParticleParameters, quaternions: FloatArray) -> FloatArray:
    """Return how far particles (N, 4), as they lie, reach above their centres, (N,)."""
    x, y = quaternions[:, 0], quaternions[:, 1]
    cosine = np.clip(np.abs(1 - 2 * (x * x + y * y)), 0, 1)  # of the particle's axis against the vertical
    return shape_of(particle).half_heights_m(particle, cosine)
