"""A button that must be held, for what moves the arm."""

from __future__ import annotations

from PySide6.QtCore import QElapsedTimer, QEvent, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QFontMetricsF,
    QHideEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
)
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller, tabular

_RING_PX = 36
_TICK_MS = 16
_MOST_TICK_S = 0.1
"""A tick counts at most this much: while the window is stuck a release goes unnoticed, so nothing is held."""
_FALL = 4.0
"""The ring falls back this many times faster than it fills."""
_KEYS = (Qt.Key.Key_Space, Qt.Key.Key_Return, Qt.Key.Key_Enter)


class HoldButton(QAbstractButton):
    """Press and hold with the mouse, Space or Enter until the ring is full.

    No QPushButton, whose style sheet would decide how small it may be.

    Attributes:
        confirmed: held to the end; the only signal that means "do it". Never connect to `clicked`.
    """

    confirmed = Signal()

    def __init__(self, text: str, hint: str = "", hold_s: float = 1.5, parent: QWidget | None = None) -> None:
        """Make one labelled `text`; `hint` replaces the standard message after an early release."""
        super().__init__(parent)
        self.setText(text)
        self.setObjectName("hold_button")
        self.setAccessibleName(text)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._hold_s = hold_s
        self._hint = hint
        self._held_s = 0.0
        self._is_holding = False
        self._is_done = False
        self._was_early = False
        self._clock = QElapsedTimer()
        self._timer = QTimer(self)
        self._timer.setInterval(_TICK_MS)
        self._timer.timeout.connect(self._tick)

    @property
    def progress(self) -> float:
        """How full the ring is, 0..1."""
        return min(self._held_s / self._hold_s, 1.0)

    @property
    def is_holding(self) -> bool:
        """Whether it is held down and not yet confirmed."""
        return self._is_holding

    def set_blocked(self, reason: str | None) -> None:
        """Disable it and say why in the tooltip, or enable it with None."""
        self.setEnabled(reason is None)
        self.setToolTip(reason or "")
        self.setAccessibleDescription(reason or "")

    def cancel(self) -> None:
        """Release without confirming; the ring falls back."""
        if self._is_holding:
            self._is_holding = False
            self._was_early = True
            self.update()

    def _begin(self) -> None:
        self._is_holding = True
        self._is_done = False
        self._was_early = False
        self._held_s = 0.0
        self._clock.start()
        self._timer.start()
        self.update()

    def _tick(self) -> None:
        passed_s = min(self._clock.restart() / 1000, _MOST_TICK_S)
        if not self._is_holding:
            self._held_s -= _FALL * passed_s
            if self._held_s <= 0:
                self._held_s = 0.0
                self._is_done = False
                self._timer.stop()
        else:
            self._held_s += passed_s
            if self._held_s >= self._hold_s:
                self._is_holding = False
                self._is_done = True
                self.confirmed.emit()
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Start holding."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._begin()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Release."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.cancel()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Leaving the button releases it."""
        if not self.rect().contains(event.position().toPoint()):
            self.cancel()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Start holding."""
        if event.key() not in _KEYS:
            super().keyPressEvent(event)
        elif not event.isAutoRepeat():
            self._begin()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Release."""
        if event.key() not in _KEYS:
            super().keyReleaseEvent(event)
        elif not event.isAutoRepeat():
            self.cancel()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Without the focus a key's release would go unnoticed."""
        self.cancel()
        super().focusOutEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        """A hidden button is not held."""
        self.cancel()
        super().hideEvent(event)

    def changeEvent(self, event: QEvent) -> None:
        """A disabled button counts as released."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.EnabledChange and not self.isEnabled():
            self.cancel()

    def sizeHint(self) -> QSize:
        """Return a good size."""
        bold = QFontMetricsF(tabular(self.font(), bold=True))
        small = QFontMetricsF(smaller(self.font()))
        widest = max(bold.horizontalAdvance(self.text()), small.horizontalAdvance(self._second_line("early")))
        return QSize(round(widest) + _RING_PX + 5 * GRID_PX, _RING_PX + 3 * GRID_PX)

    def minimumSizeHint(self) -> QSize:
        """Return the least size it can be read at."""
        return self.sizeHint()

    def _second_line(self, state: str) -> str:
        if state == "early":
            return self._hint or self.tr("Released too early")
        if state == "done":
            return self.tr("Confirmed")
        return self.tr("Hold for {seconds} s").format(seconds=f"{self._hold_s:.3g}")

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the button, its ring and its two lines."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        theme = theme_of(self)
        is_on = self.isEnabled()
        box = QRectF(self.rect()).adjusted(1.5, 1.5, -1.5, -1.5)
        ink = theme.color("on_accent" if is_on else "muted")
        painter.setPen(QPen(theme.color("text"), 2) if self.hasFocus() else Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("accent" if is_on else "raised"))
        painter.drawRoundedRect(box, GRID_PX, GRID_PX)
        ring = QRectF(box.left() + 1.5 * GRID_PX, 0, _RING_PX - 6, _RING_PX - 6)
        ring.moveTop(box.center().y() - ring.height() / 2)
        faint = theme.color("on_accent" if is_on else "line")
        faint.setAlphaF(0.3 if is_on else 1.0)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(faint, 6))
        painter.drawEllipse(ring)
        painter.setPen(QPen(ink, 6, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
        painter.drawArc(ring, 90 * 16, round(-360 * 16 * self.progress))
        self._paint_words(painter, box, ring.right() + 1.5 * GRID_PX)
        painter.end()

    def _paint_words(self, painter: QPainter, box: QRectF, left: float) -> None:
        theme = theme_of(self)
        painter.setPen(theme.color("on_accent" if self.isEnabled() else "muted"))
        state = "done" if self._is_done else "early" if self._was_early else "rest"
        middle = box.center().y()
        width = box.right() - left - GRID_PX / 2
        painter.setFont(tabular(self.font(), bold=True))
        up = QRectF(left, box.top(), width, middle - box.top())
        painter.drawText(up, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignBottom, self.text())
        painter.setFont(smaller(self.font()))
        down = QRectF(left, middle + 1, width, box.bottom() - middle)
        painter.drawText(down, Qt.AlignmentFlag.AlignLeft, self._second_line(state))
