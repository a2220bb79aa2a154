"""The footprint from above: where the candies that stayed fell from."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller, tick_step
from core.geometry import FloatArray
from core.report.plot_geometry import FootprintPlan


class _Frame:
    """From metres (x right, y up) to pixels, with the same scale on both axes."""

    def __init__(self, area: QRectF, low_m: FloatArray, high_m: FloatArray) -> None:
        size = np.maximum(high_m - low_m, 1e-3)
        self.px_per_m = float(min(area.width() / size[0], area.height() / size[1]) * 0.94)
        self._middle_m = (low_m + high_m) / 2
        self._middle_px = area.center()
        self.area = area

    def point(self, x_m: float, y_m: float) -> QPointF:
        dx, dy = x_m - float(self._middle_m[0]), y_m - float(self._middle_m[1])
        return self._middle_px + QPointF(dx * self.px_per_m, -dy * self.px_per_m)

    def range_m(self, axis: int) -> tuple[float, float]:
        """What the area shows along x (0) or y (1)."""
        half = (self.area.width() if axis == 0 else self.area.height()) / 2 / self.px_per_m
        middle = float(self._middle_m[axis])
        return middle - half, middle + half


class FootprintView(QWidget):
    """Drop positions kept and lost, the object's outline, pour centre and principal axes; in mm."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("footprint")
        self.setAccessibleName(self.tr("Footprint from above"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setToolTip(
            self.tr(
                "Where the candies started, seen from above (base frame).\n"
                "The pour centre is the mean of those that stayed; the lines are their principal axes,\n"
                "two standard deviations each way (paper, Sec. III-A)."
            )
        )
        self._shown: FootprintPlan | None = None

    def set_footprint(self, plan: FootprintPlan) -> None:
        """Show one footprint."""
        self._shown = plan
        self.setAccessibleDescription(
            self.tr("{kept} of {n} candies stayed").format(kept=plan.n_kept, n=len(plan.retained))
        )
        self.update()

    def clear(self) -> None:
        """Show that there is none yet."""
        self._shown = None
        self.setAccessibleDescription("")
        self.update()

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(320, 300)

    def minimumSizeHint(self) -> QSize:
        """Return the smallest legible size."""
        return QSize(200, 180)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint axes, object, candies and the pour centre."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(smaller(self.font()))
        line = QFontMetricsF(painter.font()).height()
        left = QFontMetricsF(painter.font()).horizontalAdvance("-888") + 8
        area = QRectF(left, GRID_PX, self.width() - left - GRID_PX, self.height() - 2 * line - 2.5 * GRID_PX)
        theme = theme_of(self)
        painter.fillRect(area, theme.color("surface"))
        if self._shown is None or len(self._shown.drops_m) + len(self._shown.outline_m) == 0:
            painter.setFont(self.font())
            painter.setPen(theme.color("muted"))
            text = self.tr("The footprint appears here\nonce candies have been dropped")
            painter.drawText(area, Qt.AlignmentFlag.AlignCenter, text)
        else:
            frame = _Frame(area, *self._shown.extent_m())
            self._paint_axes(painter, frame)
            painter.save()
            painter.setClipRect(area)
            self._paint_object(painter, frame, self._shown)
            self._paint_drops(painter, frame, self._shown)
            self._paint_center(painter, frame, self._shown)
            painter.restore()
            self._paint_legend(painter, area, self._shown)
        painter.end()

    def _paint_axes(self, painter: QPainter, frame: _Frame) -> None:
        theme = theme_of(self)
        metrics = QFontMetricsF(painter.font())
        step = tick_step(48 / frame.px_per_m)
        area = frame.area
        for axis in (0, 1):
            low, high = frame.range_m(axis)
            for k in range(int(np.ceil(low / step)), int(np.floor(high / step)) + 1):
                at = frame.point(k * step, k * step)
                text = f"{1000 * k * step:.0f}"
                painter.setPen(QPen(theme.color("line"), 1))
                if axis == 0:
                    painter.drawLine(QPointF(at.x(), area.top()), QPointF(at.x(), area.bottom()))
                    box = QRectF(at.x() - 30, area.bottom() + 2, 60, metrics.height())
                    flags = Qt.AlignmentFlag.AlignHCenter
                else:
                    painter.drawLine(QPointF(area.left(), at.y()), QPointF(area.right(), at.y()))
                    box = QRectF(0, at.y() - metrics.height() / 2, area.left() - 4, metrics.height())
                    flags = Qt.AlignmentFlag.AlignRight
                painter.setPen(theme.color("muted"))
                if box.right() <= self.width() and box.left() >= -30 and box.top() >= -2:
                    painter.drawText(box, flags, text)

    def _paint_object(self, painter: QPainter, frame: _Frame, shown: FootprintPlan) -> None:
        theme = theme_of(self)
        fill = theme.color("body")
        fill.setAlphaF(0.22)
        painter.setBrush(fill)
        painter.setPen(QPen(theme.color("muted"), 1.5))
        painter.drawPolygon(QPolygonF([frame.point(x, y) for x, y in shown.outline_m]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(theme.color("text"), 1.2, Qt.PenStyle.DashLine))
        if shown.center_m is not None:
            center = frame.point(*shown.center_m)
            for radius_m in shown.pivot_radii_m:
                painter.drawEllipse(center, radius_m * frame.px_per_m, radius_m * frame.px_per_m)

    def _paint_drops(self, painter: QPainter, frame: _Frame, shown: FootprintPlan) -> None:
        size = min(max(0.0022 * frame.px_per_m, 2.2), 5.0)
        for (x, y), is_kept in zip(shown.drops_m, shown.retained, strict=True):
            self._paint_drop(painter, frame.point(x, y), bool(is_kept), size)

    def _paint_drop(self, painter: QPainter, at: QPointF, is_kept: bool, size: float) -> None:
        """A full disc for kept, a cross for lost."""
        theme = theme_of(self)
        if is_kept:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(theme.color("kept"))
            painter.drawEllipse(at, size, size)
        else:
            painter.setPen(QPen(theme.color("lost"), 1.6))
            painter.drawLine(at + QPointF(-size, -size), at + QPointF(size, size))
            painter.drawLine(at + QPointF(-size, size), at + QPointF(size, -size))

    def _paint_center(self, painter: QPainter, frame: _Frame, shown: FootprintPlan) -> None:
        if shown.center_m is None:
            return
        theme = theme_of(self)
        at = frame.point(*shown.center_m)
        halo = theme.color("surface")
        halo.setAlphaF(0.6)
        styles = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine)
        for (begin, end), style in zip(() if shown.axes_m is None else shown.axes_m, styles, strict=False):
            for pen in (QPen(halo, 4), QPen(theme.color("text"), 1.8, style)):
                painter.setPen(pen)
                painter.drawLine(frame.point(*begin), frame.point(*end))
        painter.setPen(QPen(theme.color("surface"), 2))
        painter.setBrush(theme.color("text"))
        painter.drawEllipse(at, 5.5, 5.5)
        metrics = QFontMetricsF(painter.font())
        name = self.tr("Pour centre")
        box = QRectF(at.x() + 8, at.y() - metrics.height() - 3, metrics.horizontalAdvance(name) + 6, 0)
        box.setHeight(metrics.height())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("surface"))
        painter.drawRoundedRect(box, 3, 3)
        painter.setPen(theme.color("text"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)

    def _paint_legend(self, painter: QPainter, area: QRectF, shown: FootprintPlan) -> None:
        theme = theme_of(self)
        metrics = QFontMetricsF(painter.font())
        words = (
            (True, self.tr("{n} kept").format(n=shown.n_kept)),
            (False, self.tr("{n} lost").format(n=len(shown.retained) - shown.n_kept)),
        )
        x, y = area.left() + 4, self.height() - metrics.height() / 2 - 3
        for is_kept, text in words:
            self._paint_drop(painter, QPointF(x, y), is_kept, 4.0)
            painter.setPen(theme.color("text"))
            box = QRectF(x + GRID_PX, y - metrics.height() / 2, metrics.horizontalAdvance(text) + 4, 40)
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft, text)
            x = box.right() + 1.5 * GRID_PX
        painter.setPen(theme.color("muted"))
        box = QRectF(area.left(), y - metrics.height() / 2, area.width(), metrics.height())
        painter.drawText(box, Qt.AlignmentFlag.AlignRight, self.tr("x, y in mm"))

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
