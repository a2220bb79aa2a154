"""Filling the cup: where the candies lie before it is poured."""

from __future__ import annotations

from itertools import product
from math import floor

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray, invert_pose, transform_points
from core.imagination.cup import cup_pose, inner_radius_m
from core.imagination.particle_shape import particle_extents_m
from core.parameters import Parameters

_SLOT_PITCHES = (1.15, 1.02)
"""Distance of neighbours at the start, relative to the particle, so that none overlap even when jittered; the
closer one where the candies find no room otherwise."""
_FREE_AT_MOUTH = 0.1
"""Share of the cup's length kept free at its mouth, so that nothing falls out before the turn."""


def pack_cup(parameters: Parameters, packing: int) -> FloatArray:
    """Return (N_pour, 3) starting positions in the lying cup, E-local frame; they differ with `packing`.

    Raises:
        StageError: the cup cannot hold N_pour candies.
    """
    n_pour = parameters.pouring.n_pour
    pitch, slots = require_room(parameters)
    generator = np.random.default_rng([parameters.seed, 1, packing])
    # From the middle of the cup, as in the released code: the candies fall and come to rest as they may.
    from_middle = np.abs(slots[:, 0] - parameters.pouring.cup.length_m / 2)
    central = slots[np.argsort(from_middle, kind="stable")][: max(n_pour, len(slots) // 2)]
    chosen = central[generator.permutation(len(central))[:n_pour]]
    shift = 0.4 * (pitch - 1) * particle_extents_m(parameters.particle)
    packed: FloatArray = chosen + generator.uniform(-shift, shift, chosen.shape)
    return packed


def require_room(parameters: Parameters) -> tuple[float, FloatArray]:
    """Return the pitch and the places (n, 3) in the cup, of which there are at least N_pour.

    Raises:
        StageError: the cup cannot hold N_pour candies.
    """
    n_pour = parameters.pouring.n_pour
    pitch, slots = _widest(parameters)
    if len(slots) < n_pour:
        raise StageError(
            f"The cup cannot hold {n_pour} candies: lying as it does before a pour it has room for "
            f"{len(slots)}; lower pouring.n_pour or enlarge the cup (pouring.cup)."
        )
    return pitch, slots


def cup_holds(parameters: Parameters) -> bool:
    """Return whether the cup has room for N_pour candies, lying as it does before a pour."""
    return len(_widest(parameters)[1]) >= parameters.pouring.n_pour


def _widest(parameters: Parameters) -> tuple[float, FloatArray]:
    """The largest pitch with enough slots, and these; the closest one if none has."""
    for pitch in _SLOT_PITCHES:
        slots = _slots(parameters, pitch)
        if len(slots) >= parameters.pouring.n_pour:
            break
    return pitch, slots


def _slots(parameters: Parameters, slot_pitch: float) -> FloatArray:
    """All places (n, 3) of a grid, E-local frame, at which a flat candy lies wholly inside the cup."""
    cup = parameters.pouring.cup
    extents = particle_extents_m(parameters.particle)
    pitch = slot_pitch * extents
    reach = cup.length_m, 2 * cup.mouth_radius_m, 2 * cup.mouth_radius_m
    counts = [floor(length / step) for length, step in zip(reach, pitch, strict=True)]
    middles = cup.length_m / 2, 0.0, cup.mouth_radius_m - cup.wall_m - cup.pivot_lift_m
    axes = [
        middle + step * (np.arange(count) - (count - 1) / 2)
        for middle, step, count in zip(middles, pitch, counts, strict=True)
    ]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    slots = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    T_cup_E = invert_pose(cup_pose(cup, np.zeros(3), 0.0, 0.0))
    # A candy fits when the corners of its box, grown to the pitch, lie inside the cone.
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * pitch
    in_cup = transform_points(T_cup_E, slots[:, None, :] + corners)
    height, radius = in_cup[..., 2], np.hypot(in_cup[..., 0], in_cup[..., 1])
    inside = (
        (radius < inner_radius_m(cup, height))
        & (height > cup.wall_m)
        & (height < (1 - _FREE_AT_MOUTH) * cup.length_m)
    )
    fits = inside.all(axis=1)
    fitting: FloatArray = slots[fits]
    return fitting
