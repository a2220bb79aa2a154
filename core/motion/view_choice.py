"""Which of the reachable views to take: spread over the dome, steep ones included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry import FloatArray
from core.motion.view_planning import ReachableView

LOWEST_ELEVATION_DEG = 20.0
COVERED_WITHIN_DEG = 25.0
_STEEP_DEG = 75.0
_STEEP_WEIGHT = 4.0
"""Directions this steep count so much more: floors of deep cups show only there, walls show from many
sides."""
_KERNEL_DEG = 14.0
"""How far a view's worth reaches: with 24 views on the dome, neighbours stand about 25 degrees apart."""
_DOME_SAMPLES = 1000


def choose_spread_views(views: Sequence[ReachableView], n_views: int) -> tuple[ReachableView, ...]:
    """Pick views (at most `n_views`) that together are near to as many dome directions as possible.

    Greedy, which is within 37 % of the best for this submodular measure (Nemhauser et al. 1978): each next
    view is the one that adds most, weighted by its quality; views of one direction compete, the best of
    them is taken.
    """
    candidates = _best_of_each_direction(views)
    if not candidates:
        return ()
    dome, weights = _weighted_dome()
    worth = np.array([view.quality for view in candidates])[:, None] * _nearness(candidates, dome)
    covered = np.zeros(len(dome))
    chosen: list[ReachableView] = []
    for _ in range(min(n_views, len(candidates))):
        gains = (np.maximum(worth - covered, 0) * weights).sum(axis=1)
        best = int(gains.argmax())
        chosen.append(candidates[best])
        covered = np.maximum(covered, worth[best])
        worth[best] = -1
    return tuple(chosen)


def coverage(directions: FloatArray) -> float:
    """Share of the dome's directions (20 to 90 degrees of elevation) within 25 degrees of a view's (K, 3)."""
    cosines = dome_directions(_DOME_SAMPLES, LOWEST_ELEVATION_DEG) @ directions.T
    return float((cosines.max(axis=1) >= np.cos(np.radians(COVERED_WITHIN_DEG))).mean())


def dome_directions(n: int, lowest_elevation_deg: float) -> FloatArray:
    """Unit vectors (n, 3) spread evenly over the dome's surface (a Fibonacci spiral)."""
    lowest = np.sin(np.radians(lowest_elevation_deg))
    z = lowest + (1 - lowest) * (np.arange(n) + 0.5) / n
    azimuth = np.arange(n) * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def _weighted_dome() -> tuple[FloatArray, FloatArray]:
    dome = dome_directions(_DOME_SAMPLES, LOWEST_ELEVATION_DEG)
    steep = dome[:, 2] >= np.sin(np.radians(_STEEP_DEG))
    return dome, np.where(steep, _STEEP_WEIGHT, 1.0)


def _nearness(views: Sequence[ReachableView], dome: FloatArray) -> FloatArray:
    """How near (K, N), 1 to 0, each view is to each dome direction."""
    cosines = np.clip(np.array([view.direction for view in views]) @ dome.T, -1, 1)
    return np.asarray(np.exp(-((np.degrees(np.arccos(cosines)) / _KERNEL_DEG) ** 2)))


def _best_of_each_direction(views: Sequence[ReachableView]) -> list[ReachableView]:
    best: dict[tuple[float, ...], ReachableView] = {}
    for view in sorted(views, key=lambda view: view.quality, reverse=True):
        best.setdefault(tuple(view.direction.round(3)), view)
    return list(best.values())
