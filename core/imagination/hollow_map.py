"""Where an object at rest holds something, seen from above, and what cannot leave it any more."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from core.geometry import AnyArray, BoolArray, FloatArray, IntArray
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
        is_open: (X, Y) whether nothing of the object lies above what is held there: what falls straight
            down comes in, not onto the shoulder of a bottle.
    """

    origin_m: FloatArray
    pitch_m: float
    rim_m: FloatArray
    floor_m: FloatArray
    is_open: BoolArray

    def rim_at(self, places_m: FloatArray) -> FloatArray:
        """Return (n,) heights of the rims at (n, 2) places; minus infinity where nothing is held, or NaN."""
        i, j = self._nearest(places_m)
        rims: FloatArray = self.rim_m[i, j]
        return rims

    @property
    def lowest_m(self) -> float:
        """Height of the inner floor; infinity where nothing is held at all."""
        return float(self.floor_m.min())

    def holds_at(self, places_m: FloatArray, height_m: float) -> BoolArray:
        """Return (n,) whether something at a height is held at (n, 2) places."""
        i, j = self._nearest(places_m)
        held: BoolArray = (self.floor_m[i, j] <= height_m) & (height_m <= self.rim_m[i, j])
        return held

    def room_at(self, places_m: FloatArray) -> FloatArray:
        """Return (n,) distances of (n, 2) places from the nearest one that is not open; there, zero."""
        i, j = self._nearest(places_m)
        rooms: FloatArray = self.room_m[i, j]
        return rooms

    def to_arrays(self) -> dict[str, AnyArray]:
        """Return what `from_arrays` makes it from: finite, heights rounded to less than a micrometre."""
        holds = np.isfinite(self.floor_m)
        rim_m, floor_m = (np.where(holds, heights_m, 0.0) for heights_m in (self.rim_m, self.floor_m))
        return {
            "hollow_origin_m": self.origin_m,
            "hollow_pitch_m": np.array(self.pitch_m),
            "hollow_holds": holds,
            "hollow_is_open": self.is_open,
            "hollow_rim_m": rim_m.astype(np.float32),
            "hollow_floor_m": floor_m.astype(np.float32),
        }

    @staticmethod
    def from_arrays(arrays: Mapping[str, AnyArray]) -> HollowMap:
        """Make one from its arrays; in sessions of earlier versions all that holds counts as open."""
        holds = arrays["hollow_holds"]
        return HollowMap(
            origin_m=arrays["hollow_origin_m"],
            pitch_m=float(arrays["hollow_pitch_m"]),
            rim_m=np.where(holds, arrays["hollow_rim_m"], -np.inf).astype(float),
            floor_m=np.where(holds, arrays["hollow_floor_m"], np.inf).astype(float),
            is_open=arrays.get("hollow_is_open", holds),
        )

    @cached_property
    def room_m(self) -> FloatArray:
        """(X, Y) distance of each place from the nearest one that is not open; there, zero."""
        from scipy.ndimage import distance_transform_edt  # not in the window

        rooms: FloatArray = self.pitch_m * distance_transform_edt(self.is_open)
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
