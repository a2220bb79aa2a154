"""How the pour map is painted: cells, marks, rim and legend."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, degrees, hypot, pi, radians, sin

from PySide6.QtCore import QCoreApplication, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QLinearGradient, QPainter, QPainterPath, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.color_scale import text_on, viridis
from app.gui.views.painting import hatch, smaller, tabular
from core.report.plot_geometry import Arc, PourMapLayout

RIM_PX = 26
"""Around the rings, for the directions."""
LEGEND_PX = 40
"""Under them, for the colour scale and the rings' distances."""
_FULL_ARC = 0.25
"""Spread at which the arc is as wide as its cell."""
_SMALL_POINTS = 10.0
"""Font size up to which the star is small, too."""


def place(center: QPointF, radius: float, angle_rad: float) -> QPointF:
    """Return the point at a polar place about the map's centre; y of the screen points down."""
    return center + QPointF(radius * cos(angle_rad), -radius * sin(angle_rad))


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
        self._points = min(max(self._font.pointSizeF() * depth / 40, 9.0), 15.0)

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
        p: float,
        spread: float | None,
        is_hatched: bool,
        other: float | None,
        away_px: float,
    ) -> None:
        """Draw one cell: its colour and number, its spread, and whether the arm cannot do it.

        The number is `away_px` off the middle, away from where the star would be.
        """
        color = viridis(p)
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
        lines = [(f"{100 * p:.0f}", self._points, True)]
        if other is not None:
            lines.append((points_text(p - other), self._points - 1.5, False))
        middle = place(self._center, *self._layout.middle(i, j))
        off = middle - self._star(i, j)
        middle += off * (away_px / max(hypot(off.x(), off.y()), 1.0))
        self._write(middle, lines, ink, color if is_hatched else None)

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

    def paint_chosen(self, i: int, j: int, p: float) -> None:
        """Outline the chosen cell inside and put a star into its corner."""
        ink = text_on(viridis(p))
        self.strokePath(self._outline(i, j, 3.0), QPen(ink, 2))
        center, size = self._star(i, j), self._star_px
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

    def paint_legend(self, indents_m: Sequence[float], other_label: str) -> None:
        """Draw the colour scale, 0 to 100 %, and write how far the rings are from the middle."""
        top = self._size.height() - LEGEND_PX + 4
        self.setFont(smaller(self._font))
        metrics = QFontMetricsF(self.font())
        bar = QRectF(0, top, min(150.0, self._size.width() * 0.4), 10)
        bar.moveLeft(self._size.width() - bar.width() - GRID_PX - metrics.horizontalAdvance("100 %") / 2)
        gradient = QLinearGradient(bar.topLeft(), bar.topRight())
        for k in range(11):
            gradient.setColorAt(k / 10, viridis(k / 10))
        scale = QPainterPath()
        scale.addRoundedRect(bar, 2, 2)
        self.fillPath(scale, gradient)
        self.setPen(self._theme.color("muted"))
        for ratio in (0.0, 0.5, 1.0):
            box = QRectF(0, bar.bottom() + 2, 60, metrics.height())
            box.moveLeft(bar.left() + ratio * bar.width() - 30)
            self.drawText(box, Qt.AlignmentFlag.AlignHCenter, f"{100 * ratio:.0f} %")
        self._paint_words(bar, indents_m, other_label)

    def _paint_words(self, bar: QRectF, indents_m: Sequence[float], other_label: str) -> None:
        metrics = QFontMetricsF(self.font())
        name = QRectF(bar.left() - 26, bar.top() - 3, 22, metrics.height())
        self.drawText(name, Qt.AlignmentFlag.AlignRight, "P")
        lines = []
        if indents_m:
            distances = ", ".join(f"{1000 * indent:.0f}" for indent in indents_m)
            lines.append(QCoreApplication.translate("PourMap", "rings {mm} mm").format(mm=distances))
        if other_label:
            lines.append(QCoreApplication.translate("PourMap", "± to {label}").format(label=other_label))
        for k, line in enumerate(lines):
            box = QRectF(
                GRID_PX, bar.top() - 3 + k * metrics.height(), name.left() - GRID_PX, metrics.height()
            )
            text = metrics.elidedText(line, Qt.TextElideMode.ElideRight, box.width())
            self.drawText(box, Qt.AlignmentFlag.AlignLeft, text)
