"""Where an object at rest holds something, seen from above, and what cannot leave it any more."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.imagination.bullet_world import GRAVITY_M_S2

_ENERGY = 2.0
"""Times its own kinetic energy: what hits a candy may hand it more than it has."""


@dataclass(frozen=True)
class HollowMap:
    """Floor and rim of the hollows over a grid of places, heights in the frame of the object's mesh.

    Attributes:
        origin_m: (2,) of the first place.
        pitch_m: of the places.
        rim_m: (X, Y) height over which something runs that is held there; minus infinity where nothing is.
        floor_m: (X, Y) height of the lowest that is held there; infinity where nothing is.
    """

    origin_m: FloatArray
    pitch_m: float
    rim_m: FloatArray
    floor_m: FloatArray

    def rim_at(self, places_m: FloatArray) -> FloatArray:
        """Return (n,) heights of the rims at (n, 2) places; minus infinity where nothing is held, or NaN."""
        i, j = self._nearest(places_m)
        rims: FloatArray = self.rim_m[i, j]
        return rims

    def room_at(self, places_m: FloatArray) -> FloatArray:
        """Return (n,) distances of (n, 2) places from the nearest one where nothing is held; there, zero."""
        i, j = self._nearest(places_m)
        rooms: FloatArray = self._room_m[i, j]
        return rooms

    @cached_property
    def _room_m(self) -> FloatArray:
        from scipy.ndimage import distance_transform_edt  # not in the window

        rooms: FloatArray = self.pitch_m * distance_transform_edt(np.isfinite(self.rim_m))
        return rooms

    def keeps(self, positions_m: FloatArray, speeds_m_s: FloatArray) -> BoolArray:
        """Return (n,) whether particles lie in a hollow, too slow to rise to its rim.

        Args:
            positions_m: (n, 3) of their centres; NaN: there is none.
            speeds_m_s: (n,).
        """
        i, j = self._nearest(positions_m[:, :2])
        rises_m = _ENERGY * speeds_m_s**2 / (2 * GRAVITY_M_S2)
        heights_m = positions_m[:, 2]
        with np.errstate(invalid="ignore"):
            kept: BoolArray = (heights_m > self.floor_m[i, j]) & (heights_m + rises_m < self.rim_m[i, j])
        return kept

    def _nearest(self, places_m: FloatArray) -> tuple[IntArray, IntArray]:
        last = np.array(self.rim_m.shape) - 1
        found = np.rint((np.nan_to_num(places_m) - self.origin_m) / self.pitch_m).clip(0, last)
        i, j = found.astype(np.int64).T
        return i, j
