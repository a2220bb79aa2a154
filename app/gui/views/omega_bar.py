"""Omega on a bar from 0 to 1 with the threshold that decides."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
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
        return self.tr("Omega {omega}").format(omega=_numbers(self._omega, self._threshold)[0])

    def threshold_text(self) -> str:
        """The threshold as it is written under the bar."""
        return self.tr("threshold {threshold}").format(threshold=_numbers(self._omega, self._threshold)[1])

    def _explain(self) -> str:
        if self._omega is None:
            return self.tr("Omega is the share of the dropped candies that stay (paper, Sec. III-A).")
        omega, threshold = _numbers(self._omega, self._threshold)
        if self._omega > self._threshold:
            verdict = self.tr("above the threshold {threshold}.")
        else:
            verdict = self.tr("not above the threshold {threshold}.")
        stayed = self.tr("Omega {omega} of 1: {percent} % of the dropped candies stayed,").format(
            omega=omega, percent=f"{100 * self._omega:.1f}"
        )
        return stayed + " " + verdict.format(threshold=threshold)

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(280, self._lines_px() + _BAR_PX)

    def minimumSizeHint(self) -> QSize:
        """Return the least size it can be read at."""
        return QSize(160, self._lines_px() + _BAR_PX)

    def _lines_px(self) -> int:
        large = QFontMetricsF(tabular(self.font(), self.font().pointSizeF() + 2, bold=True)).height()
        return round(large + QFontMetricsF(smaller(self.font())).height() + 12)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the bar, the threshold and their numbers."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self)
        large = tabular(self.font(), self.font().pointSizeF() + 2, bold=True)
        top = QFontMetricsF(large).height() + 4  # the threshold ends below the letters
        bar = QRectF(GRID_PX, top, self.width() - 2 * GRID_PX, _BAR_PX)
        painter.setFont(large)
        painter.setPen(theme.color("text"))
        painter.drawText(
            QRectF(bar.left(), 0, bar.width(), top), Qt.AlignmentFlag.AlignLeft, self.omega_text()
        )
        painter.setPen(QPen(theme.color("line"), 1))
        painter.setBrush(theme.color("surface"))
        painter.drawRoundedRect(bar, 3, 3)
        if self._omega:
            filled = QRectF(bar)
            filled.setWidth(bar.width() * min(max(self._omega, 0.0), 1.0))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(theme.color("accent"))
            painter.drawRoundedRect(filled, 3, 3)
        self._paint_threshold(painter, bar)
        painter.end()

    def _paint_threshold(self, painter: QPainter, bar: QRectF) -> None:
        theme = theme_of(self)
        x = bar.left() + bar.width() * min(max(self._threshold, 0.0), 1.0)
        painter.setPen(QPen(theme.color("window"), 4))
        painter.drawLine(QPointF(x, bar.top() - 2), QPointF(x, bar.bottom() + 2))
        painter.setPen(QPen(theme.color("text"), 2))
        painter.drawLine(QPointF(x, bar.top() - 3), QPointF(x, bar.bottom() + 3))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("text"))
        tip = QPointF(x, bar.bottom() + 1)
        painter.drawPolygon(QPolygonF([tip, tip + QPointF(-5, 7), tip + QPointF(5, 7)]))
        self._paint_scale(painter, bar, x)

    def _paint_scale(self, painter: QPainter, bar: QRectF, x: float) -> None:
        """Write the threshold beside its mark, and 0 and 1 where they fit."""
        painter.setFont(smaller(self.font()))
        metrics = QFontMetricsF(painter.font())
        painter.setPen(theme_of(self).color("muted"))
        text = self.threshold_text()
        box = QRectF(x + 9, bar.bottom() + 3, metrics.horizontalAdvance(text) + 2, metrics.height())
        if box.right() > bar.right():
            box.moveRight(x - 9)
        painter.drawText(box, Qt.AlignmentFlag.AlignLeft, text)
        line = QRectF(bar.left(), box.top(), bar.width(), box.height())
        digit = metrics.horizontalAdvance("0") + GRID_PX
        if min(x - 5, box.left()) > bar.left() + digit:
            painter.drawText(line, Qt.AlignmentFlag.AlignLeft, "0")
        if max(x + 5, box.right()) < bar.right() - digit:
            painter.drawText(line, Qt.AlignmentFlag.AlignRight, "1")


def _numbers(omega: float | None, threshold: float) -> tuple[str, str]:
    """Both with two digits; with more where two would hide a difference that decides."""
    for digits in (2, 3, 4):
        texts = (f"{omega or 0.0:.{digits}f}", f"{threshold:.{digits}f}")
        hides_omega = omega is not None and any(
            omega != edge and texts[0] == f"{edge:.{digits}f}" for edge in (0.0, 1.0, threshold)
        )
        if not hides_omega:
            break
    return texts
