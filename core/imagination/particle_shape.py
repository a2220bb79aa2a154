"""The candy's shape (Sec. IV-C)."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.parameters.imagination import ParticleParameters

_ELLIPSOID_RINGS = (0.0, 0.45, 0.8)
_ELLIPSOID_SIDES = 12


def particle_extents_m(particle: ParticleParameters) -> FloatArray:
    """Edge lengths (3,) of the AABB of a particle lying flat."""
    height = particle.diameter_m if particle.shape == "sphere" else particle.height_m
    return np.array([particle.diameter_m, particle.diameter_m, height])


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
