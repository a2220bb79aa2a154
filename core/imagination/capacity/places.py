"""Above which places it rains: the footprint, kept clear of the rim."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.capacity.basin import Basin

_LEAST = 4
"""Fewer clear places than this, and the widest are taken whether they are clear or not."""


def rain_places(basin: Basin, footprint_m: FloatArray, radius_m: float, apart_m: float) -> FloatArray:
    """Return (n, 2) places above a hollow and near the footprint, where a particle falls clear of the rim.

    What falls onto the rim bounces off and would look as if the object had run over. Without a hollow it
    rains on the footprint as it is.

    Args:
        basin: what the object holds by geometry.
        footprint_m: (m, 2) places from which candies stayed.
        radius_m: of what rains.
        apart_m: distance of neighbours in the drop's grid.
    """
    from scipy.ndimage import distance_transform_edt
    from scipy.spatial import cKDTree

    is_hollow = np.isfinite(basin.rim_map_m)
    cells = np.argwhere(is_hollow)
    if not len(cells):
        return footprint_m
    places = basin.map_origin_m + basin.map_pitch_m * cells
    away_m, _ = cKDTree(footprint_m).query(places)
    near: BoolArray = np.asarray(away_m) <= apart_m
    if not near.any():
        return footprint_m
    places, room_m = places[near], basin.map_pitch_m * distance_transform_edt(is_hollow)[is_hollow][near]
    enough_m = min(radius_m, float(np.sort(room_m)[-min(_LEAST, len(room_m))]))
    clear: FloatArray = places[room_m >= enough_m]
    return clear
