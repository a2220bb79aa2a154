"""The candy's shape (Sec. IV-C)."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.parameters.imagination import ParticleParameters

_ELLIPSOID_RINGS = (0.0, 0.6)
_ELLIPSOID_SIDES = 12
_SKIN = 0.7


def particle_extents_m(particle: ParticleParameters) -> FloatArray:
    """Edge lengths (3,) of the AABB of a particle lying flat."""
    height = particle.diameter_m if particle.shape == "sphere" else particle.height_m
    return np.array([particle.diameter_m, particle.diameter_m, height])


def half_heights_m(particle: ParticleParameters, quaternions: FloatArray) -> FloatArray:
    """Return how far particles (N, 4), as they lie, reach above their centres, (N,)."""
    radius_m, half_m = particle.diameter_m / 2, particle.height_m / 2
    if particle.shape == "sphere":
        return np.full(len(quaternions), radius_m)
    x, y = quaternions[:, 0], quaternions[:, 1]
    cosine = np.clip(np.abs(1 - 2 * (x * x + y * y)), 0, 1)  # of the particle's axis against the vertical
    sine = np.sqrt(1 - cosine * cosine)
    if particle.shape == "cylinder":
        heights: FloatArray = radius_m * sine + half_m * cosine
    else:
        heights = np.hypot(radius_m * sine, half_m * cosine)
    return heights


def ellipsoid_skin_m(particle: ParticleParameters) -> float:
    """Thickness of the round skin (Bullet's collision margin) around a hull that stands for an ellipsoid.

    While only skins touch, contacts are quick to find and exact, and a fast candy is seen by a wall before it
    is in it: the same pours take half the time and fewer parts of a step.
    """
    return _SKIN * min(particle.diameter_m, particle.height_m) / 2


def ellipsoid_hull_m(diameter_m: float, height_m: float) -> FloatArray:
    """Vertices (n, 3) of the convex hull that stands for an ellipsoid flattened along z."""
    angles = np.arange(_ELLIPSOID_SIDES) * 2 * np.pi / _ELLIPSOID_SIDES
    vertices = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    for z in _ELLIPSOID_RINGS:
        radius = np.sqrt(1 - z * z)
        ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full_like(angles, z)])
        vertices += ring.tolist()
        if z > 0:
            vertices += (ring * [1, 1, -1]).tolist()
    return np.array(vertices) * [diameter_m / 2, diameter_m / 2, height_m / 2]
