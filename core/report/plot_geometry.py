"""Where everything on the pour map and on the footprint's plot lies, for whatever draws them.

Numbers alone: the window draws them with Qt, the report with matplotlib.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.results import Containability, Footprint

HOLE_RATIO = 0.22
"""Radius of the map's empty middle, where p_E is, to the whole."""
FEWEST_SECTORS = 8
"""A single direction gets an eighth of the circle."""
SHORTEST_AXIS_M = 0.004
"""What is drawn of a principal axis each way at least."""


@dataclass(frozen=True)
class Arc:
    """Part of a circle about the map's centre; the angle grows anticlockwise, the sweep may be negative."""

    radius: float
    begin_rad: float
    sweep_rad: float


@dataclass(frozen=True)
class PourMapLayout:
    """Sectors of equal width about their directions, rings of equal depth around an empty middle.

    Attributes:
        directions_rad: (I,) middle of each sector, anticlockwise from the right.
        n_rings: number of rings.
        radius: of the outermost ring's outer edge, in any unit; all lengths are in it.
    """

    directions_rad: tuple[float, ...]
    n_rings: int
    radius: float = 1.0

    @property
    def half_rad(self) -> float:
        """Half the width of a sector."""
        return pi / max(len(self.directions_rad), FEWEST_SECTORS)

    @property
    def hole(self) -> float:
        """Radius of the empty middle."""
        return HOLE_RATIO * self.radius

    def ring(self, j: int) -> tuple[float, float]:
        """Return inner and outer radius of ring j."""
        depth = (self.radius - self.hole) / max(self.n_rings, 1)
        return self.hole + j * depth, self.hole + (j + 1) * depth

    def middle(self, i: int, j: int) -> tuple[float, float]:
        """Return radius and angle of a cell's middle."""
        return sum(self.ring(j)) / 2, self.directions_rad[i]

    def cell(self, i: int, j: int, inset: float = 0.0) -> tuple[Arc, Arc]:
        """Return the outer edge and, in the opposite sense, the inner edge of a cell drawn in by `inset`."""
        inner, outer = self.ring(j)
        inner, outer = inner + inset, outer - inset
        begin_rad, sweep_rad = self.directions_rad[i] - self.half_rad, 2 * self.half_rad
        cut_in, cut_out = inset / inner, inset / outer
        return (
            Arc(outer, begin_rad + cut_out, sweep_rad - 2 * cut_out),
            Arc(inner, begin_rad + sweep_rad - cut_in, 2 * cut_in - sweep_rad),
        )

    def inner_arc(self, i: int, j: int, ratio: float, inset: float) -> Arc:
        """Return an arc along a cell's inner edge, `ratio` of its width long, about its middle."""
        radius = self.ring(j)[0] + inset
        half_rad = ratio * (self.half_rad - inset / radius)
        return Arc(radius, self.directions_rad[i] - half_rad, 2 * half_rad)

    def cell_at(self, x: float, y: float) -> tuple[int, int] | None:
        """Return the cell at a place from the centre (x right, y up), or None."""
        radius, angle_rad = hypot(x, y), atan2(y, x)
        for j in range(self.n_rings):
            inner, outer = self.ring(j)
            if inner <= radius < outer:
                for i, direction_rad in enumerate(self.directions_rad):
                    if abs((angle_rad - direction_rad + pi) % (2 * pi) - pi) <= self.half_rad:
                        return i, j
        return None


@dataclass(frozen=True)
class FootprintPlan:
    """The footprint from above, in metres of the base frame: x right, y up.

    Attributes:
        drops_m: (n, 2) where the candies started.
        retained: (n,) whether each stayed.
        outline_m: (m, 2) polygon of the object, or of its bounding box.
        center_m: (2,) p_E; None when nothing stayed.
        axes_m: (2, 2, 2) ends of the long and of the short principal axis, two standard deviations each way;
            None when nothing stayed.
        pivot_radii_m: distances of the pivots from p_E.
    """

    drops_m: FloatArray
    retained: BoolArray
    outline_m: FloatArray
    center_m: FloatArray | None = None
    axes_m: FloatArray | None = None
    pivot_radii_m: tuple[float, ...] = ()

    @staticmethod
    def of(
        containability: Containability,
        outline_m: FloatArray | None = None,
        pivot_radii_m: Sequence[float] = (),
    ) -> FootprintPlan:
        """Lay out what was imagined; without an outline (m, 2) the object is its bounding box."""
        footprint = containability.footprint
        return FootprintPlan(
            containability.drop_positions_m[:, :2],
            containability.retained.astype(bool),
            _box(containability.aabb_m) if outline_m is None else outline_m,
            None if footprint is None else footprint.center_m[:2],
            None if footprint is None else _axes(footprint),
            tuple(pivot_radii_m),
        )

    @property
    def n_kept(self) -> int:
        """How many candies stayed."""
        return int(self.retained.sum())

    def extent_m(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner (2,) of all that is drawn."""
        points = [self.drops_m, self.outline_m]
        if self.center_m is not None:
            reach = max(self.pivot_radii_m, default=0.0)
            points.append(np.array([self.center_m - reach, self.center_m + reach]))
        stacked = np.concatenate(points)
        return stacked.min(axis=0), stacked.max(axis=0)


def _box(aabb_m: FloatArray) -> FloatArray:
    (x0, y0), (x1, y1) = aabb_m[:, :2]
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _axes(footprint: Footprint) -> FloatArray:
    axes = []
    for angle_rad, deviation_m in zip(
        (footprint.axis_rad, footprint.axis_rad + pi / 2), footprint.deviations_m, strict=True
    ):
        along = np.array([cos(angle_rad), sin(angle_rad)]) * max(2 * deviation_m, SHORTEST_AXIS_M)
        axes.append([footprint.center_m[:2] - along, footprint.center_m[:2] + along])
    return np.array(axes)
