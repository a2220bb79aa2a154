"""How far from an opening's edge the candies of a pour fall into it: what is left for errors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry import FloatArray
from core.imagination.hollow_map import HollowMap
from core.imagination.recording import POSITION_STEP_M, Recording
from core.imagination.results import PourGrid

_OF_CANDIES = 0.1
"""So many may enter nearer to the edge: a single one that strayed says little."""
_AS_CLEAR = 0.95
"""Times the largest clearance, above which others are as clear: over a wide opening most are."""


def clearances_m(grid: PourGrid, hollows: HollowMap, diameter_m: float) -> FloatArray:
    """Return (I, 3) the clearance of each pour, from the recording of its first packing.

    Args:
        grid: the imagined pours.
        hollows: of the object.
        diameter_m: of a candy.
    """
    rows = [[entry_clearance_m(one, hollows, diameter_m / 2) for one in row] for row in grid.recordings]
    return np.array(rows)


def entry_clearance_m(recording: Recording, hollows: HollowMap, below_m: float) -> float:
    """Return how far from the edge nine of ten candies are where they are in a hollow for the first time.

    Between two recorded moments a candy goes straight.

    Args:
        recording: of a pour.
        hollows: of the object, in the recording's frame.
        below_m: a candy is in when its centre is so far below the rim; one that never is, is at the edge.
    """
    # As they are kept: what is read again gives the same.
    positions_m = np.rint(recording.positions_m / POSITION_STEP_M).astype(np.float64) * POSITION_STEP_M
    heights_m = positions_m[:, :, 2]
    n_times, n_candies = heights_m.shape
    rims_m = hollows.rim_at(positions_m[:, :, :2].reshape(-1, 2))
    levels_m = rims_m.reshape(n_times, n_candies) - below_m
    with np.errstate(invalid="ignore"):
        is_in = heights_m < levels_m
    candies = np.flatnonzero(is_in.any(axis=0))
    room_m = np.zeros(n_candies)
    if len(candies):
        after = is_in[:, candies].argmax(axis=0)
        start, end = positions_m[np.maximum(after - 1, 0), candies], positions_m[after, candies]
        fallen_m = np.maximum(start[:, 2] - end[:, 2], np.finfo(np.float64).tiny)
        share = ((start[:, 2] - levels_m[after, candies]) / fallen_m).clip(0, 1)
        room_m[candies] = hollows.room_at(start[:, :2] + share[:, None] * (end - start)[:, :2])
    return float(np.quantile(room_m, _OF_CANDIES))


def clearest_first(order: Sequence[tuple[int, int]], clearance_m: FloatArray) -> list[tuple[int, int]]:
    """Return pours (i, j) with the largest clearance (I, 3) first; such as are as clear keep their order."""
    left, ranked = list(order), list[tuple[int, int]]()
    while left:
        enough_m = _AS_CLEAR * max(clearance_m[pour] for pour in left)
        ranked += [pour for pour in left if clearance_m[pour] >= enough_m]
        left = [pour for pour in left if clearance_m[pour] < enough_m]
    return ranked
