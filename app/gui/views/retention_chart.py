"""The retention curve: how many candies are still inside as the object is tilted."""

from __future__ import annotations

from math import degrees, isfinite

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFontMetricsF, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller
from core.geometry import FloatArray
from core.imagination.retention.result import Retention

_TICK_DEG = 30
_HEIGHT_PX, _LEAST_WIDTH_PX = 130, 160
_KEY_PX = 24


class RetentionChart(QWidget):
    """Share of the loaded candies still inside, against the tilt: the mean; dashed, the worst direction.

    The tilts at which the first candy, a tenth and half of them are gone are marked. A tilt can be pointed at
    with mouse or arrow keys.

    Signals: `tilt_pointed_at` with an angle in radians.
    """

    tilt_pointed_at = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("retention_chart")
        self.setAccessibleName(self.tr("Candies still inside, against the tilt"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._retention: Retention | None = None
        self._pointed_rad: float | None = None

    @property
    def pointed_rad(self) -> float | None:
        """The tilt that is pointed at; none if none is."""
        return self._pointed_rad

    def point_at(self, tilt_rad: float | None) -> None:
        """Mark a tilt, without a signal; none: none."""
        self._pointed_rad = tilt_rad
        self.update()

    def show_retention(self, retention: Retention | None) -> None:
        """Show a curve; none, or one without a load: that there is none."""
        self._retention = retention if retention is not None and retention.n_load else None
        self._pointed_rad = None
        tip = ""
        if self._retention is not None:
            tip = self.tr(
                "Share of {n} candies still inside as the object is tilted; drag along it to tilt the object"
            )
            tip = tip.format(n=self._retention.n_load)
        self.setToolTip(tip)
        self.update()

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(280, _HEIGHT_PX)

    def minimumSizeHint(self) -> QSize:
        """Return the least size it can be read at."""
        return QSize(_LEAST_WIDTH_PX, _HEIGHT_PX)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint scales, both curves and what they are."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(smaller(self.font()))
        if self._retention is None:
            painter.setPen(theme_of(self).color("muted"))
            said = self.tr("No tilting was imagined, or nothing stayed that could fall out.")
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, said)
        else:
            self._paint_curves(painter, self._retention)
        painter.end()

    @override
    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Point at a tilt."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._point_to(event.position().x())

    @override
    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Point at another one while the button is held."""
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._point_to(event.position().x())

    @override
    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Point at the step before or after."""
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        step = steps.get(Qt.Key(event.key()))
        if step is None or self._retention is None:
            super().keyPressEvent(event)
            return
        tilts_rad = self._retention.tilt_rad
        now = 0 if self._pointed_rad is None else int(np.abs(tilts_rad - self._pointed_rad).argmin())
        self._point(float(tilts_rad[min(max(now + step, 0), len(tilts_rad) - 1)]))

    def _point_to(self, x: float) -> None:
        if self._retention is None:
            return
        box = self._box(QFontMetricsF(smaller(self.font())))
        share = min(max((x - box.left()) / max(box.width(), 1.0), 0.0), 1.0)
        tilts_rad = self._retention.tilt_rad
        self._point(float(tilts_rad[int(np.abs(tilts_rad - share * tilts_rad[-1]).argmin())]))

    def _point(self, tilt_rad: float) -> None:
        if tilt_rad != self._pointed_rad:
            self.point_at(tilt_rad)
            self.tilt_pointed_at.emit(tilt_rad)

    def _box(self, metrics: QFontMetricsF) -> QRectF:
        """Where the curves are: below the marks' names, above the scale and the key."""
        line = metrics.height()
        left, right = metrics.horizontalAdvance("100 %") + GRID_PX, metrics.horizontalAdvance("90") / 2 + 4
        top = 1.6 * line
        return QRectF(left, top, self.width() - left - right, self.height() - 3 * line - GRID_PX - top)

    def _paint_curves(self, painter: QPainter, retention: Retention) -> None:
        theme, metrics = theme_of(self), QFontMetricsF(painter.font())
        box = self._box(metrics)
        self._paint_scales(painter, box, degrees(float(retention.tilt_rad[-1])))
        curves = (
            (self.tr("worst direction"), "lost", Qt.PenStyle.DashLine, retention.worst_share_left),
            (self.tr("mean of all"), "kept", Qt.PenStyle.SolidLine, retention.mean_share_left),
        )
        self._paint_marks(painter, box, retention)
        right_px = float(self.width())
        for label, color, style, share in curves:
            pen = QPen(theme.color(color), 2, style)
            painter.setPen(pen)
            painter.drawPolyline(_curve(box, retention.tilt_rad, share))
            right_px = self._paint_key(painter, label, pen, right_px) - 2 * GRID_PX
        painter.setPen(theme.color("muted"))
        painter.drawText(QPointF(0, self.height() - metrics.descent()), self.tr("Tilt"))

    def _paint_marks(self, painter: QPainter, box: QRectF, retention: Retention) -> None:
        """Where the first, a tenth and half are gone, and the tilt that is pointed at."""
        theme, metrics = theme_of(self), QFontMetricsF(painter.font())
        most_rad, free_px = float(retention.tilt_rad[-1]), box.left()
        for name, tilt_rad in self.marks(retention):
            x = box.left() + tilt_rad / most_rad * box.width()
            painter.setPen(QPen(theme.color("text"), 1, Qt.PenStyle.DotLine))
            painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()))
            width = metrics.horizontalAdvance(name)
            left = max(min(x - width / 2, self.width() - width), free_px)
            if left + width <= self.width():
                painter.drawText(QPointF(left, box.top() - metrics.descent() - 1), name)
                free_px = left + width + GRID_PX / 2
        if self._pointed_rad is not None:
            x = box.left() + self._pointed_rad / most_rad * box.width()
            painter.setPen(QPen(theme.color("accent"), 2))
            painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()))

    def marks(self, retention: Retention) -> list[tuple[str, float]]:
        """Return the marked tilts, of the worst direction, with their names; what never leaves has none."""
        found = (
            (self.tr("first"), retention.first_rad),
            (self.tr("tenth"), retention.tenth_rad),
            (self.tr("half"), retention.half_rad),
        )
        names: dict[float, str] = {}
        for name, tilt_rad in found:
            if isfinite(tilt_rad):
                names[tilt_rad] = f"{names[tilt_rad]}, {name}" if tilt_rad in names else name
        return [
            (f"{name} {degrees(tilt_rad):.0f}\N{DEGREE SIGN}", tilt_rad) for tilt_rad, name in names.items()
        ]

    def _paint_key(self, painter: QPainter, label: str, pen: QPen, right_px: float) -> float:
        """Say at the bottom what a line is, to the left of a place; return where that begins."""
        metrics = QFontMetricsF(painter.font())
        x = right_px - metrics.horizontalAdvance(label) - 1
        painter.setPen(theme_of(self).color("text"))
        painter.drawText(QPointF(x, self.height() - metrics.descent()), label)
        painter.setPen(pen)
        y = self.height() - metrics.height() / 2
        painter.drawLine(QPointF(x - _KEY_PX - GRID_PX / 2, y), QPointF(x - GRID_PX / 2, y))
        return x - _KEY_PX - GRID_PX / 2

    def _paint_scales(self, painter: QPainter, box: QRectF, most_deg: float) -> None:
        theme, metrics = theme_of(self), QFontMetricsF(painter.font())
        for share in (0.0, 0.5, 1.0):
            y = box.bottom() - share * box.height()
            painter.setPen(QPen(theme.color("line"), 1))
            painter.drawLine(QPointF(box.left(), y), QPointF(box.right(), y))
            painter.setPen(theme.color("muted"))
            label = QRectF(0, y - metrics.height() / 2, box.left() - GRID_PX / 2, metrics.height())
            painter.drawText(label, Qt.AlignmentFlag.AlignRight, f"{100 * share:.0f} %")
        for tilt_deg in range(0, round(most_deg) + 1, _TICK_DEG):
            x = box.left() + tilt_deg / most_deg * box.width()
            painter.setPen(QPen(theme.color("line"), 1))
            painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()))
            painter.setPen(theme.color("muted"))
            label = QRectF(x - 20, box.bottom() + GRID_PX / 2, 40, metrics.height())
            painter.drawText(label, Qt.AlignmentFlag.AlignHCenter, f"{tilt_deg}\N{DEGREE SIGN}")


def _curve(box: QRectF, tilt_rad: FloatArray, share: FloatArray) -> QPolygonF:
    """Points of a curve from (S,) tilts and shares."""
    places = zip(tilt_rad / tilt_rad[-1], share, strict=True)
    return QPolygonF(
        [QPointF(box.left() + x * box.width(), box.bottom() - y * box.height()) for x, y in places]
    )
