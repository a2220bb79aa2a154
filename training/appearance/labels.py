"""Which pixels contain: surface that bounds the hollow below the rim, as seen. From geometry alone."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.capacity.water import find_basin
from core.imagination.hollow_map import HollowMap
from core.mesh import TriangleMesh
from core.parameters.bodies import ParticleParameters
from hardware.simulation.world import World

_SMALLEST_ML = 1.0
_LATTICE_POINTS = 150_000
_RIM_M = 0.0005
"""What lies less than this below the rim is the rim."""
_OFF_SURFACE_M = 0.001
_FAR_M = 0.6
_N_SIDES, _FEWEST_SIDES = 8, 7
"""Between the bars of a sieve one side may be open."""
_REACH_M = 0.004
"""So far beside the hollow's points its walls are: the lattice ends before them."""


class Hollow:
    """The hollow of an object where it stands."""

    def __init__(self, mesh: TriangleMesh, world: World) -> None:
        """Fill it: what candies reach counts. The world is the object's, to look around in."""
        self._world = world
        basin = find_basin(mesh, ParticleParameters().height_m, _SMALLEST_ML, _LATTICE_POINTS)
        self._map: HollowMap = _with_walls(basin.hollow_map)

    def contains(self, points_m: FloatArray, eye_m: FloatArray) -> BoolArray:
        """Whether points (N, 3) of a surface, as seen from `eye_m`, bound the hollow below its rim.

        They lie below the rim, the line of sight comes in over the hollow, and on their level the object is
        all around: so an outer wall is none, also where a belly hangs over it, and no shoulder is.
        """
        rims_m = self._map.rim_at(points_m[:, :2])
        below = np.isfinite(rims_m) & (points_m[:, 2] < rims_m - _RIM_M)
        inside = np.zeros(len(points_m), dtype=np.bool_)
        if not below.any() or eye_m[2] <= rims_m[below].max():
            return inside
        share = (rims_m[below] - points_m[below, 2]) / (eye_m[2] - points_m[below, 2])
        entries_m = points_m[below] + share[:, None] * (eye_m - points_m[below])
        inside[below] = np.isfinite(self._map.rim_at(entries_m[:, :2]))
        inside[inside] = self._is_enclosed(points_m[inside], eye_m)
        return inside

    def _is_enclosed(self, points_m: FloatArray, eye_m: FloatArray) -> BoolArray:
        """Whether the object is on nearly all sides of points (N, 3), a little off the surface."""
        to_eye = eye_m - points_m
        seen_from = points_m + _OFF_SURFACE_M * to_eye / np.linalg.norm(to_eye, axis=1, keepdims=True)
        angles = 2 * np.pi * np.arange(_N_SIDES) / _N_SIDES
        far = _FAR_M * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_N_SIDES)])
        hits = [self._world.hidden((seen_from + side)[None], seen_from[None])[0] for side in far]
        enclosed: BoolArray = np.sum(hits, axis=0) >= _FEWEST_SIDES
        return enclosed


def _with_walls(seen: HollowMap) -> HollowMap:
    """Return the map with its rims grown by what lies beside the lattice's points."""
    from dataclasses import replace

    from scipy.ndimage import maximum_filter

    steps = max(round(_REACH_M / seen.pitch_m), 1)
    y, x = np.mgrid[-steps : steps + 1, -steps : steps + 1]
    grown = maximum_filter(seen.rim_m, footprint=np.hypot(x, y) <= steps, mode="constant", cval=-np.inf)
    return replace(seen, rim_m=grown)
