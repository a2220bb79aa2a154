"""How the pour map is painted: cells, marks, rim and legend."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, cos, degrees, hypot, pi, radians, sin

from PySide6.QtCore import QCoreApplication, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontMetricsF,
    QLinearGradient,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.color_scale import text_on, viridis
from app.gui.views.painting import draw_elided, hatch, smaller, tabular
from core.report.plot_geometry import Arc, PourMapLayout

RIM_PX = 26
"""Around the rings, for the directions."""
_SCALE_LINES, _MARKS_LINES, _MOST_WORDS, _AROUND_PX = 2.3, 1.25, 2, 2.0
_FULL_ARC = 0.25
"""Spread at which the arc is as wide as its cell."""
_LEGEND_STAR_PX = 6.0
_LEAST_POINTS, _BESIDE_PX, _FRAME_PX = 7.0, 3.0, 3.0
_SMALL_POINTS = 10.0
"""Font size up to which the star is small, too."""


def place(center: QPointF, radius: float, angle_rad: float) -> QPointF:
    """Return the point at a polar place about the map's centre; y of the screen points down."""
    return center + QPointF(radius * cos(angle_rad), -radius * sin(angle_rad))


def legend_px(font: QFont) -> int:
    """Return the height under the rings for the colour scale, the marks and the rings' distances."""
    line = QFontMetricsF(smaller(font)).height()
    return ceil(2 * _AROUND_PX + (_SCALE_LINES + _MARKS_LINES + _MOST_WORDS) * line)


def points_text(difference: float) -> str:
    """Return a difference of two ratios in points with its sign; none for nothing."""
    points = round(100 * difference)
    return f"{points:+d}".replace("-", "\u2212") if points else "0"


class PourMapPainter(QPainter):
    """A painter on a pour map, for one paint event."""

    def __init__(self, widget: QWidget, layout: PourMapLayout, center: QPointF) -> None:
        super().__init__(widget)
        self.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._theme = theme_of(widget)
        self._font = widget.font()
        self._size = widget.size()
        self._layout = layout
        self._center = center
        depth = layout.ring(1)[0] - layout.ring(0)[0]
        self._room_px = depth - _BESIDE_PX
        self._points = self._fitting(
            min(max(self._font.pointSizeF() * depth / 40, 9.0), 15.0), "100", bold=True
        )

    def _fitting(self, points: float, text: str, bold: bool, room_px: float | None = None) -> float:
        """The font size at which a text fits, `points` at most; 0 where it would be unreadable.

        Left and right of the middle the text lies along the radius, so that a ring's depth is its room.
        """
        room_px = self._room_px if room_px is None else room_px
        width_px = QFontMetricsF(tabular(self._font, points, bold=bold)).horizontalAdvance(text)
        fitting = points * min(room_px / width_px, 1.0)
        return fitting if fitting >= _LEAST_POINTS else 0.0

    @property
    def _star_px(self) -> float:
        return 6.0 if self._points > _SMALL_POINTS else 4.5

    def paint_rings(self) -> None:
        """Draw the bare rings, for where no pour is."""
        self.setBrush(Qt.BrushStyle.NoBrush)
        self.setPen(QPen(self._theme.color("line"), 1))
        for j in range(self._layout.n_rings):
            radius = self._layout.ring(j)[1]
            self.drawEllipse(self._center, radius, radius)

    def paint_empty(self, text: str) -> None:
        """Say what will be here."""
        self.setPen(self._theme.color("muted"))
        self.setFont(self._font)
        box = QRectF(0, 0, 2 * self._layout.radius, 60)
        box.moveCenter(self._center)
        self.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def paint_cell(
        self,
        i: int,
        j: int,
        value: float,
        small: str,
        spread: float | None,
        is_hatched: bool,
        away_px: float,
    ) -> None:
        """Draw one cell: its colour and number, a small one, its spread, and whether the arm cannot do it.

        The numbers are `away_px` off the middle, away from where the star would be.
        """
        color = viridis(value)
        ink = text_on(color)
        path = self._outline(i, j, 1.0)
        self.fillPath(path, color)
        if is_hatched:
            faint = QColor(ink)
            faint.setAlphaF(0.55)
            hatch(self, path, faint)
        if spread:
            arc = self._layout.inner_arc(i, j, min(spread / _FULL_ARC, 1.0), 5.0)
            self.strokePath(self._path(arc), QPen(ink, 3, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
        if not self._points:
            return  # the colour says it, and the tooltip
        lines = [(f"{100 * value:.0f}", self._points, True)]
        room_px = self._framed_room_px(j) if away_px else None
        if small and (
            small_points := self._fitting(
                max(self._points - 3, _LEAST_POINTS), small, bold=False, room_px=room_px
            )
        ):
            lines.append((small, small_points, False))
        middle = place(self._center, *self._layout.middle(i, j))
        off = middle - self._star(i, j)
        middle += off * (away_px / max(hypot(off.x(), off.y()), 1.0))
        self._write(middle, lines, ink, color if is_hatched else None)

    def _framed_room_px(self, j: int) -> float:
        """How wide a text may be in the narrower half of a cell whose outline is drawn strongly."""
        inner, outer = self._layout.ring(j)
        across_px = 2 * (0.7 * inner + 0.3 * outer) * sin(self._layout.half_rad)
        return min(self._room_px, across_px) - 2 * _FRAME_PX

    def _outline(self, i: int, j: int, inset_px: float) -> QPainterPath:
        """The outline of a cell, drawn in by `inset_px` on every side."""
        path = self._path(*self._layout.cell(i, j, inset_px))
        path.closeSubpath()
        return path

    def _path(self, *arcs: Arc) -> QPainterPath:
        """Arcs, joined by straight lines."""
        path = QPainterPath()
        for arc in arcs:
            box = QRectF(0, 0, 2 * arc.radius, 2 * arc.radius)
            box.moveCenter(self._center)
            if path.isEmpty():
                path.arcMoveTo(box, degrees(arc.begin_rad))
            path.arcTo(box, degrees(arc.begin_rad), degrees(arc.sweep_rad))
        return path

    def _write(
        self, middle: QPointF, lines: Sequence[tuple[str, float, bool]], ink: QColor, plate: QColor | None
    ) -> None:
        """Write lines of (text, points, bold) about a point, on a plate where hatching would disturb."""
        fonts = [tabular(self._font, points, bold=bold) for _, points, bold in lines]
        sizes = [
            QFontMetricsF(font).tightBoundingRect(text)
            for (text, _, _), font in zip(lines, fonts, strict=True)
        ]
        gap = 4.0
        height = sum(size.height() for size in sizes) + gap * (len(lines) - 1)
        width = max(size.width() for size in sizes)
        if plate is not None:
            box = QRectF(0, 0, width + 8, height + 6)
            box.moveCenter(middle)
            self.setPen(Qt.PenStyle.NoPen)
            self.setBrush(plate)
            self.drawRoundedRect(box, 3, 3)
        self.setPen(ink)
        top = middle.y() - height / 2
        for (text, _, _), font, size in zip(lines, fonts, sizes, strict=True):
            self.setFont(font)
            self.drawText(QPointF(middle.x() - size.center().x(), top - size.top()), text)
            top += size.height() + gap

    def paint_chosen(self, i: int, j: int, value: float) -> None:
        """Outline the chosen cell inside and put a star into its corner."""
        ink = text_on(viridis(value))
        self.strokePath(self._outline(i, j, 1.5), QPen(ink, 2))
        self._draw_star(self._star(i, j), self._star_px, ink)

    def _draw_star(self, center: QPointF, size: float, ink: QColor) -> None:
        points = [
            center + QPointF(r * sin(k * pi / 5), -r * cos(k * pi / 5))
            for k, r in ((k, size if k % 2 == 0 else 0.43 * size) for k in range(10))
        ]
        self.setPen(Qt.PenStyle.NoPen)
        self.setBrush(ink)
        self.drawPolygon(QPolygonF(points))

    def _star(self, i: int, j: int) -> QPointF:
        """Where the star of a cell is: in its outer corner."""
        radius = self._layout.ring(j)[1] - self._star_px - 4.5
        angle = self._layout.directions_rad[i] + self._layout.half_rad - (self._star_px + 5.0) / radius
        return place(self._center, radius, angle)

    def paint_selected(self, i: int, j: int, has_focus: bool) -> None:
        """Outline the selected cell outside, more strongly while keys move it."""
        path = self._outline(i, j, -1.0)
        self.strokePath(path, QPen(self._theme.color("window"), 7))
        width = 4.0 if has_focus else 3.0
        self.strokePath(path, QPen(self._theme.color("text"), width))

    def paint_rim(self, rotation_deg: float, has_center: bool) -> None:
        """Write the directions around, and what the middle is."""
        self.setFont(smaller(self._font))
        metrics = QFontMetricsF(self.font())
        self.setPen(self._theme.color("muted"))
        for deg in range(0, 360, 45):
            text = f"{deg}°" if deg else "x 0°"
            middle = place(self._center, self._layout.radius + RIM_PX / 2 + 1, radians(deg + rotation_deg))
            box = QRectF(0, 0, metrics.horizontalAdvance(text) + 2, metrics.height())
            box.moveCenter(middle)
            self.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
        if not has_center:
            return
        box = QRectF(0, 0, 2 * self._layout.hole, 2 * metrics.height())
        box.moveCenter(self._center)
        name = QCoreApplication.translate("PourMap", "Pour\ncentre")
        self.drawText(box, Qt.AlignmentFlag.AlignCenter, name)

    def paint_legend(self, title: str, words: Sequence[str], has_marks: bool) -> None:
        """Draw the colour scale, 0 to 100 %, the marks, and lines of words, under the rings.

        Args:
            title: what the colours stand for.
            words: a line each, two at most.
            has_marks: whether hatching, arc and star are explained.
        """
        self.setFont(smaller(self._font))
        line = QFontMetricsF(self.font()).height()
        left = float(GRID_PX)
        top = self._size.height() - legend_px(self._font) + _AROUND_PX
        self._paint_scale(title, QRectF(left, top, self._size.width() - 2 * left, line))
        y = top + _SCALE_LINES * line
        if has_marks:
            self._paint_marks(left, y, line)
            y += _MARKS_LINES * line
        self.setPen(self._theme.color("muted"))
        for text in words:
            box = QRectF(left, y, self._size.width() - 2 * left, line)
            draw_elided(self, box, text, Qt.AlignmentFlag.AlignLeft)
            y += line

    def _paint_scale(self, title: str, row: QRectF) -> None:
        """The title at the left of a row, at its right the bar with its numbers under it."""
        metrics = QFontMetricsF(self.font())
        bar = QRectF(0, row.top() + 3, 0.4 * row.width(), row.height() - 5)
        bar.moveRight(row.right() - metrics.horizontalAdvance("100 %") / 2)
        gradient = QLinearGradient(bar.topLeft(), bar.topRight())
        for k in range(11):
            gradient.setColorAt(k / 10, viridis(k / 10))
        scale = QPainterPath()
        scale.addRoundedRect(bar, 2, 2)
        self.fillPath(scale, gradient)
        self.setPen(self._theme.color("text"))
        draw_elided(
            self, row.adjusted(0, 0, bar.left() - row.right() - GRID_PX, 0), title, Qt.AlignmentFlag.AlignLeft
        )
        self.setPen(self._theme.color("muted"))
        for ratio in (0.0, 0.5, 1.0):
            box = QRectF(0, bar.bottom() + 2, 60, metrics.height())
            box.moveLeft(bar.left() + ratio * bar.width() - 30)
            self.drawText(box, Qt.AlignmentFlag.AlignHCenter, f"{100 * ratio:.0f} %")

    def _paint_marks(self, left: float, top: float, line: float) -> None:
        """What hatching, arc and star mean, side by side."""
        translate, metrics = QCoreApplication.translate, QFontMetricsF(self.font())
        ink, muted = self._theme.color("text"), self._theme.color("muted")
        words = (
            translate("PourMap", "arm cannot"),
            translate("PourMap", "spread"),
            translate("PourMap", "chosen"),
        )
        x = left
        for k, text in enumerate(words):
            box = QRectF(x, top + 1, 1.5 * line, line - 2)
            if k == 0:
                path = QPainterPath()
                path.addRect(box)
                hatch(self, path, ink)
                self.strokePath(path, QPen(muted, 1))
            elif k == 1:
                self.setPen(QPen(ink, 3, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
                self.drawLine(box.bottomLeft() + QPointF(2, -4), box.bottomRight() + QPointF(-2, -4))
            else:
                self._draw_star(box.center(), _LEGEND_STAR_PX, ink)
            self.setPen(muted)
            x = box.right() + GRID_PX / 2
            self.drawText(QPointF(x, top + metrics.ascent()), text)
            x += metrics.horizontalAdvance(text) + 1.5 * GRID_PX
