"""Where the candies are dropped from (Sec. III-A, the rule for N_x, N_y, N_z and s)."""

from __future__ import annotations

from math import ceil, floor, sqrt

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray
from core.imagination.particle_shape import particle_extents_m
from core.parameters.imagination import ContainabilityParameters, ParticleParameters


def grid_counts(extents_m: FloatArray, pitch_m: FloatArray, n_max: int, n_min: int) -> tuple[int, int, int]:
    """Return (N_x, N_y, N_z) for an object and a particle of the given AABB extents.

    Raises:
        StageError: the object is smaller than a particle.
    """

    def counts(scale: float) -> tuple[int, int]:
        return floor(scale * extents_m[0] / pitch_m[0]), floor(scale * extents_m[1] / pitch_m[1])

    n_x, n_y = counts(1.0)
    if n_x * n_y == 0:
        width, depth = (1000 * extents_m[:2]).round(1)
        raise StageError(
            f"The object ({width} x {depth} mm from above) is smaller than a candy "
            f"({1000 * pitch_m[0]:.1f} mm with its margin): choose a smaller particle.diameter_m, "
            "or check that the mesh is in metres."
        )
    if n_x * n_y > n_max:
        # An object many candies long and one wide would be scaled to none: one row always stays.
        scaled = counts(sqrt(n_max / (n_x * n_y)))
        return max(scaled[0], 1), max(scaled[1], 1), 1
    return n_x, n_y, ceil(n_min / (n_x * n_y)) if n_x * n_y < n_min else 1


def pitch_m(particle: ParticleParameters, parameters: ContainabilityParameters) -> FloatArray:
    """Extents (3,) of a candy's AABB with its margin."""
    return particle_extents_m(particle) + 2 * parameters.pitch_margin_m


def drop_positions(
    aabb_m: FloatArray,
    particle: ParticleParameters,
    parameters: ContainabilityParameters,
    generator: np.random.Generator,
) -> FloatArray:
    """Return (N_drop, 3) positions in a grid over the top face of `aabb_m` (2, 3), lightly jittered."""
    low, high = aabb_m
    n_x, n_y, n_z = grid_counts(high - low, pitch_m(particle, parameters), parameters.n_max, parameters.n_min)
    layers = high[2] + parameters.layer_height_m + parameters.layer_spacing_m * np.arange(n_z)
    z, y, x = np.meshgrid(layers, _spread(low[1], high[1], n_y), _spread(low[0], high[0], n_x), indexing="ij")
    positions = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    jitter: FloatArray = generator.uniform(-parameters.jitter_m, parameters.jitter_m, positions.shape)
    return positions + jitter


def _spread(low: float, high: float, count: int) -> FloatArray:
    """Spread `count` values from edge to edge, as the released code does; a single one in the middle."""
    return np.linspace(low, high, count) if count > 1 else np.array([(low + high) / 2])
