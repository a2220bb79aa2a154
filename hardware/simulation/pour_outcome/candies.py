"""The candies of one pour: each of its own size, in the cup before they settle, or in the object already."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, floor, pi, radians, sin

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray, ellipsoid_inertia_kg_m2, transform_points
from core.imagination.cup import inner_radius_m
from core.parameters.bodies import CupParameters
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_SIDES = 16
_LENTIL_HEIGHTS = (-0.7, 0.0, 0.7)
_SKIN = 0.6
"""Thickness of a candy's skin, relative to half its thickness: while only skins touch, contacts are quick to
find and exact, and a fast candy is seen by a wall before it is in it."""
_MAX_TILT_RAD = radians(20)
_BATCH_STREAM = 4
"""Of the seed: 0 and 1 are the candies' sizes and places, 2 and 3 the errors of object and cup."""
_APART = 1.02
_LARGEST_SD = 3.0


@dataclass(frozen=True)
class Candies:
    """Candies, each of its own size.

    Attributes:
        scales: (N,) size of each, relative to the mean size.
        positions_m: (N, 3) centres; no two touch.
        quaternions: (N, 4) orientations, (x, y, z, w).
    """

    scales: FloatArray
    positions_m: FloatArray
    quaternions: FloatArray

    def moved(self, T_to_from: FloatArray) -> Candies:
        """Return them moved by (4, 4), or seen from another frame."""
        if not len(self.scales):
            return self
        from scipy.spatial.transform import Rotation  # late: it costs the window memory

        rotation = Rotation.from_matrix(T_to_from[:3, :3])
        quaternions: FloatArray = (rotation * Rotation.from_quat(self.quaternions)).as_quat()
        return Candies(self.scales, transform_points(T_to_from, self.positions_m), quaternions)


NO_CANDIES = Candies(np.empty(0), np.empty((0, 3)), np.empty((0, 4)))


def fill_cup(cup: CupParameters, settings: OutcomeSettings) -> Candies:
    """Draw sizes and lay candies into the standing cup, in its frame: layer upon layer, a little tilted.

    Raises:
        InputError: the cup cannot hold so many.
    """
    n = settings.n_candies
    drawn = np.random.default_rng([settings.seed, 0]).standard_normal(n)
    batch = _batch_scale(settings)
    scales = batch * (1 + settings.size_spread * np.clip(drawn, -_LARGEST_SD, _LARGEST_SD))
    random = np.random.default_rng([settings.seed, 1])
    largest = batch * (1 + _LARGEST_SD * settings.size_spread)
    width_m = _APART * largest * settings.candy_diameter_m
    # A tilted tablet is the tallest that a candy of this diameter and thickness can be.
    height_m = (
        _APART
        * largest
        * (settings.candy_diameter_m * sin(_MAX_TILT_RAD) + thickness_m(settings) * cos(_MAX_TILT_RAD))
    )
    layers = []
    for layer in range(floor((cup.length_m - cup.wall_m) / height_m)):
        below_m = cup.wall_m + layer * height_m
        places = _layer(float(inner_radius_m(cup, below_m)) - width_m / 2, width_m, random)
        layers.append(np.column_stack([places, np.full(len(places), below_m + height_m / 2)]))
    positions = np.vstack([np.empty((0, 3)), *layers])
    if len(positions) < n:
        diameter_mm = batch * settings.candy_diameter_m * 1000
        raise InputError(
            f"The cup holds only {len(positions)} candies of {diameter_mm:.1f} mm, "
            f"not for {n}; lower n_candies or take a larger cup."
        )
    return Candies(scales, positions[:n], _tilted(n, random))


def _batch_scale(settings: OutcomeSettings) -> float:
    """How large the candies of this pour are, relative to the usual ones."""
    drawn = np.random.default_rng([settings.seed, _BATCH_STREAM]).uniform(-1, 1)
    return 1 + settings.batch_spread * float(drawn)


def thickness_m(settings: OutcomeSettings) -> float:
    """Mean extent of a candy along its axis."""
    is_ball = settings.candy_shape == "ball"
    return settings.candy_diameter_m if is_ball else settings.candy_height_m


def hull_m(settings: OutcomeSettings, scale: float) -> FloatArray:
    """Vertices (n, 3) of the hull inside a candy's skin, which lies flat in z."""
    half = scale * np.array([settings.candy_diameter_m, settings.candy_diameter_m, thickness_m(settings)]) / 2
    angles = np.arange(_SIDES) * 2 * pi / _SIDES
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    if settings.candy_shape == "tablet":
        outline = [(1.0, -1.0), (1.0, 1.0)]
    else:
        outline = [(float(np.sqrt(1 - height**2)), height) for height in _LENTIL_HEIGHTS]
    rings = [np.column_stack([radius * circle, np.full(_SIDES, height)]) for radius, height in outline]
    vertices: FloatArray = np.vstack([*rings, [[0, 0, -1.0], [0, 0, 1.0]]]) * (half - skin_m(settings, scale))
    return vertices


def skin_m(settings: OutcomeSettings, scale: float) -> float:
    """Thickness of the round skin that Bullet lays around a candy's hull (its collision margin)."""
    return _SKIN * scale * min(thickness_m(settings), settings.candy_diameter_m) / 2


def inertia_kg_m2(settings: OutcomeSettings, scale: float) -> FloatArray:
    """Principal moments (3,) of a solid candy; Bullet would take those of a box around it and its margin."""
    mass_kg = settings.candy_mass_kg * scale**3
    if settings.candy_shape == "tablet":
        across_m, up_m = scale * settings.candy_diameter_m / 2, scale * settings.candy_height_m / 2
        about_x = across_m**2 / 4 + up_m**2 / 3
        return mass_kg * np.array([about_x, about_x, across_m**2 / 2])
    return ellipsoid_inertia_kg_m2(mass_kg, scale * settings.candy_diameter_m, scale * thickness_m(settings))


def _layer(radius_m: float, apart_m: float, random: np.random.Generator) -> FloatArray:
    """Places (n, 2) on rings from the wall inwards, at least `apart_m` from each other, at random angles."""
    places = [np.empty((0, 2))]
    while radius_m >= 0:
        is_ring = radius_m >= apart_m / 2
        n = floor(pi / asin(apart_m / 2 / radius_m)) if is_ring else 1
        angles = random.uniform(0, 2 * pi) + np.arange(n) * 2 * pi / n
        ring = np.column_stack([np.cos(angles), np.sin(angles)])
        places.append(ring * (radius_m if is_ring else 0.0))
        radius_m -= apart_m
    return np.vstack(places)


def _tilted(n: int, random: np.random.Generator) -> FloatArray:
    """Quaternions (n, 4) of a tilt about any horizontal axis."""
    half, axis = random.uniform(0, _MAX_TILT_RAD, n) / 2, random.uniform(0, 2 * pi, n)
    return np.column_stack(
        [np.sin(half) * np.cos(axis), np.sin(half) * np.sin(axis), np.zeros(n), np.cos(half)]
    )
