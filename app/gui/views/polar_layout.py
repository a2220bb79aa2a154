"""Where the cells of a polar map lie: sectors around a centre, rings from the inside out."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, degrees, hypot, pi, sin

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath

HOLE_RATIO = 0.22
"""Radius of the empty middle, where p_E is, to the whole."""


@dataclass(frozen=True)
class PolarLayout:
    """Sectors of equal width about their directions, rings of equal depth.

    Attributes:
        center: on the widget, px.
        radius_px: of the outermost ring's outer edge.
        directions_rad: (I,) middle of each sector on the screen, anticlockwise from the right.
        n_rings: number of rings.
        half_rad: half the width of a sector.
    """

    center: QPointF
    radius_px: float
    directions_rad: tuple[float, ...]
    n_rings: int
    half_rad: float = pi / 8

    def ring_px(self, j: int) -> tuple[float, float]:
        """Return inner and outer radius of ring j."""
        hole = HOLE_RATIO * self.radius_px
        depth = (self.radius_px - hole) / max(self.n_rings, 1)
        return hole + j * depth, hole + (j + 1) * depth

    def at(self, radius_px: float, angle_rad: float) -> QPointF:
        """Return the point at a polar place; y of the screen points down."""
        return self.center + QPointF(radius_px * cos(angle_rad), -radius_px * sin(angle_rad))

    def middle(self, i: int, j: int) -> QPointF:
        """Return the middle of a cell."""
        inner, outer = self.ring_px(j)
        return self.at((inner + outer) / 2, self.directions_rad[i])

    def cell(self, i: int, j: int, inset_px: float = 0.0) -> QPainterPath:
        """Return the outline of cell (i, j), drawn in by `inset_px` on every side."""
        inner, outer = self.ring_px(j)
        inner, outer = inner + inset_px, outer - inset_px
        begin = degrees(self.directions_rad[i] - self.half_rad)
        sweep = degrees(2 * self.half_rad)
        cut_in, cut_out = (degrees(inset_px / max(radius, 1.0)) for radius in (inner, outer))
        path = QPainterPath()
        path.arcMoveTo(self._box(outer), begin + cut_out)
        path.arcTo(self._box(outer), begin + cut_out, sweep - 2 * cut_out)
        path.arcTo(self._box(inner), begin + sweep - cut_in, -(sweep - 2 * cut_in))
        path.closeSubpath()
        return path

    def inner_arc(self, i: int, j: int, ratio: float, inset_px: float) -> QPainterPath:
        """Return an arc along a cell's inner edge, `ratio` of its width long, about its middle."""
        radius = self.ring_px(j)[0] + inset_px
        half = ratio * (self.half_rad - inset_px / radius)
        begin = degrees(self.directions_rad[i] - half)
        path = QPainterPath()
        path.arcMoveTo(self._box(radius), begin)
        path.arcTo(self._box(radius), begin, degrees(2 * half))
        return path

    def cell_at(self, point: QPointF) -> tuple[int, int] | None:
        """Return the cell under a point, or None."""
        offset = point - self.center
        radius = hypot(offset.x(), offset.y())
        ring = next(
            (j for j in range(self.n_rings) if self.ring_px(j)[0] <= radius < self.ring_px(j)[1]), None
        )
        if ring is None:
            return None
        angle = atan2(-offset.y(), offset.x())
        for i, direction in enumerate(self.directions_rad):
            if abs((angle - direction + pi) % (2 * pi) - pi) <= self.half_rad:
                return i, ring
        return None

    def _box(self, radius: float) -> QRectF:
        return QRectF(self.center.x() - radius, self.center.y() - radius, 2 * radius, 2 * radius)
