"""The retention curve: how many candies are still inside as the object is tilted."""

from __future__ import annotations

from math import degrees

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller
from core.geometry import FloatArray
from core.imagination.retention.result import Retention

_TICK_DEG = 30
_HEIGHT_PX, _LEAST_WIDTH_PX = 110, 160
_KEY_PX = 24


class RetentionChart(QWidget):
    """Share of the loaded candies still inside, against the tilt: the mean; dashed, the worst direction."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("retention_chart")
        self.setAccessibleName(self.tr("Candies still inside, against the tilt"))
        self._retention: Retention | None = None

    def show_retention(self, retention: Retention | None) -> None:
        """Show a curve; none, or one without a load: that there is none."""
        self._retention = retention if retention is not None and retention.n_load else None
        tip = ""
        if self._retention is not None:
            tip = self.tr("Share of {n} candies still inside as the object is tilted")
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

    def _paint_curves(self, painter: QPainter, retention: Retention) -> None:
        theme, metrics = theme_of(self), QFontMetricsF(painter.font())
        line = metrics.height()
        left, right = metrics.horizontalAdvance("100 %") + GRID_PX, metrics.horizontalAdvance("90") / 2 + 4
        box = QRectF(left, line / 2, self.width() - left - right, self.height() - 3.5 * line - GRID_PX)
        self._paint_scales(painter, box, degrees(float(retention.tilt_rad[-1])))
        curves = (
            (self.tr("worst direction"), "lost", Qt.PenStyle.DashLine, retention.worst_share_left),
            (self.tr("mean of all"), "kept", Qt.PenStyle.SolidLine, retention.mean_share_left),
        )
        right_px = float(self.width())
        for label, color, style, share in curves:
            pen = QPen(theme.color(color), 2, style)
            painter.setPen(pen)
            painter.drawPolyline(_curve(box, retention.tilt_rad, share))
            right_px = self._paint_key(painter, label, pen, right_px) - 2 * GRID_PX
        painter.setPen(theme.color("muted"))
        painter.drawText(QPointF(0, self.height() - metrics.descent()), self.tr("Tilt"))

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
