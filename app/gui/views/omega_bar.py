"""Omega on a bar from 0 to 1 with the threshold that decides."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller, tabular

_BAR_PX = 16


class OmegaBar(QWidget):
    """Share of candies that stayed (Omega, Sec. III-A) against the threshold, both with their numbers."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("omega_bar")
        self._omega: float | None = None
        self._threshold = 0.0
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.set_values(None, 0.0)

    @property
    def omega(self) -> float | None:
        """Omega, or None while there is none."""
        return self._omega

    @property
    def threshold(self) -> float:
        """Omega_thr."""
        return self._threshold

    def set_values(self, omega: float | None, threshold: float) -> None:
        """Show Omega in 0..1 (None: not known yet) against the threshold in 0..1."""
        self._omega = omega
        self._threshold = threshold
        self.setAccessibleName(f"{self.omega_text()}, {self.threshold_text()}")
        self.setToolTip(self._explain())
        self.update()

    def omega_text(self) -> str:
        """Omega as it is written above the bar."""
        if self._omega is None:
            return self.tr("Omega --")
        return self.tr("Omega {omega}").format(omega=_number(self._omega))

    def threshold_text(self) -> str:
        """The threshold as it is written under the bar."""
        return self.tr("threshold {threshold}").format(threshold=_number(self._threshold))

    def _explain(self) -> str:
        if self._omega is None:
            return self.tr("Omega is the share of the dropped candies that stay (paper, Sec. III-A).")
        if self._omega > self._threshold:
            said = self.tr("above the threshold {threshold}: an open container.")
        else:
            said = self.tr("not above the threshold {threshold}: no open container.")
        stayed = self.tr("Omega {omega} of 1: {percent} % of the dropped candies stayed,").format(
            omega=_number(self._omega), percent=f"{100 * self._omega:.1f}"
        )
        return stayed + " " + said.format(threshold=_number(self._threshold))

    def sizeHint(self) -> QSize:
        return QSize(280, self._lines_px() + _BAR_PX)

    def minimumSizeHint(self) -> QSize:
        return QSize(160, self._lines_px() + _BAR_PX)

    def _lines_px(self) -> int:
        large = QFontMetricsF(tabular(self.font(), self.font().pointSizeF() + 2, bold=True)).height()
        return round(large + QFontMetricsF(smaller(self.font())).height() + 12)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self)
        large = tabular(self.font(), self.font().pointSizeF() + 2, bold=True)
        top = QFontMetricsF(large).height() + 2
        bar = QRectF(GRID_PX / 2, top, self.width() - GRID_PX, _BAR_PX)
        painter.setFont(large)
        painter.setPen(theme.color("text"))
        painter.drawText(QRectF(bar.left(), 0, bar.width(), top), Qt.AlignmentFlag.AlignLeft, self.omega_text())
        painter.setPen(QPen(theme.color("line"), 1))
        painter.setBrush(theme.color("surface"))
        painter.drawRoundedRect(bar, 3, 3)
        if self._omega is not None:
            filled = QRectF(bar)
            filled.setWidth(bar.width() * min(max(self._omega, 0.0), 1.0))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(theme.color("accent"))
            painter.drawRoundedRect(filled, 3, 3)
        self._paint_threshold(painter, bar)
        painter.end()

    def _paint_threshold(self, painter: QPainter, bar: QRectF) -> None:
        theme = theme_of(self)
        painter.setFont(smaller(self.font()))
        metrics = QFontMetricsF(painter.font())
        x = bar.left() + bar.width() * min(max(self._threshold, 0.0), 1.0)
        painter.setPen(QPen(theme.color("window"), 4))
        painter.drawLine(QPointF(x, bar.top() - 2), QPointF(x, bar.bottom() + 2))
        painter.setPen(QPen(theme.color("text"), 2))
        painter.drawLine(QPointF(x, bar.top() - 3), QPointF(x, bar.bottom() + 3))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("text"))
        tip = QPointF(x, bar.bottom() + 1)
        painter.drawPolygon(QPolygonF([tip, tip + QPointF(-5, 7), tip + QPointF(5, 7)]))
        text = self.threshold_text()
        width = metrics.horizontalAdvance(text) + 2
        base = bar.bottom() + 8
        after = x + 9
        left = after if after + width <= self.width() else x - 9 - width
        painter.setPen(theme.color("muted"))
        box = QRectF(left, base - 5, width, metrics.height())
        painter.drawText(box, Qt.AlignmentFlag.AlignLeft, text)
        painter.drawText(
            QRectF(bar.right() - 20, base - 5, 20, metrics.height()), Qt.AlignmentFlag.AlignRight, "1"
        ) if box.right() < bar.right() - 20 else None

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()


def _number(ratio: float) -> str:
    """Two digits, more only where two would hide that it is not zero (or not one)."""
    if 0 < ratio < 0.005 or 0.995 <= ratio < 1:
        return f"{ratio:.4f}"
    return f"{ratio:.2f}" if round(ratio, 2) == round(ratio, 3) else f"{ratio:.3f}"
