"""Live colour and depth images."""

from __future__ import annotations

from math import ceil, floor

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QFontMetricsF,
    QHelpEvent,
    QImage,
    QLinearGradient,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
)
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.color_scale import TURBO, color_table
from app.gui.views.painting import hatch, smaller, tick_step

_TURBO = color_table(TURBO)
_TURBO_PIXELS = np.vstack(
    [np.zeros((1, 4), np.uint8), np.column_stack([_TURBO, np.full(256, 255, np.uint8)])]
)
"""(257, 4) RGBA; the first, transparent over the hatching, is for pixels without depth."""
_BAR_PX = 10
_ROUND_M = 0.05
"""The automatic range ends at multiples of it, so that it does not flicker from frame to frame."""


def thinned(pixels: NDArray[np.generic], width_px: float, height_px: float) -> NDArray[np.generic]:
    """Leave out rows and columns a widget of that size cannot show anyway, the same share of both."""
    step = max(1, floor(max(pixels.shape[1] / max(width_px, 1), pixels.shape[0] / max(height_px, 1))))
    return pixels[::step, ::step]


def is_valid_depth(depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return where there is a depth: finite and above zero."""
    valid: NDArray[np.bool_] = np.isfinite(depth_m) & (depth_m > 0)
    return valid


def range_of(depth_m: NDArray[np.float32]) -> tuple[float, float] | None:
    """Return the range that holds nearly all depths, rounded outwards to 5 cm; None without any."""
    sample = depth_m[:: max(1, depth_m.shape[0] // 120), :: max(1, depth_m.shape[1] // 160)]
    sample = sample[is_valid_depth(sample)]
    if sample.size == 0:
        return None
    low, high = np.percentile(sample, (1, 99))
    low_m = float(np.floor(low / _ROUND_M) * _ROUND_M)
    return low_m, max(float(np.ceil(high / _ROUND_M) * _ROUND_M), low_m + _ROUND_M)


def depth_colors(depth_m: NDArray[np.float32], low_m: float, high_m: float) -> NDArray[np.uint8]:
    """Return (H, W, 4) turbo RGBA, transparent where there is no depth; outside the range its ends."""
    scaled = (np.nan_to_num(depth_m, nan=0.0, posinf=0.0, neginf=0.0) - low_m) * (255 / (high_m - low_m))
    index = np.clip(scaled, 0, 255).astype(np.uint16) + 1
    index[~is_valid_depth(depth_m)] = 0
    pixels: NDArray[np.uint8] = _TURBO_PIXELS[index]
    return pixels


def scale_px(widget: QWidget) -> float:
    """Return the width of the depth scale with its numbers."""
    return QFontMetricsF(smaller(widget.font())).horizontalAdvance("0.00 m") + _BAR_PX + 1.5 * GRID_PX


class _Panel(QWidget):
    """A picture as large as fits, its proportions kept."""

    def __init__(self, empty_text: str, parent: QWidget | None) -> None:
        super().__init__(parent)
        self._image = QImage()
        self._empty_text = empty_text
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def set_empty_text(self, text: str) -> None:
        """Set the text that is shown while there is no picture."""
        self._empty_text = text
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(320, 240)

    def minimumSizeHint(self) -> QSize:
        return QSize(160, 120)

    def _available(self) -> QRectF:
        """Where the picture may be, without the scale at its right."""
        return QRectF(self.rect()).adjusted(0, 0, -self._beside_px(), 0)

    def _beside_px(self) -> float:
        """Width of the scale at the picture's right."""
        return 0.0

    def _place(self, width: int, height: int) -> QRectF:
        """Where a picture of that size is drawn."""
        area = self._available()
        scale = min(area.width() / width, area.height() / height)
        box = QRectF(0, 0, width * scale, height * scale)
        box.moveCenter(area.center())
        return box

    def _paint_empty(self, painter: QPainter) -> None:
        theme = theme_of(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("scene"))
        painter.drawRoundedRect(QRectF(self.rect()), 4, 4)
        painter.setPen(theme.color("muted"))
        flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
        box = QRectF(self.rect()).adjusted(GRID_PX, GRID_PX, -GRID_PX, -GRID_PX)
        painter.drawText(box, int(flags), self._empty_text)


class ImagePanel(_Panel):
    """A colour image."""

    def __init__(self, parent: QWidget | None = None, *, is_above_depth: bool = False) -> None:
        """Make one; above a depth panel it leaves the scale's width free, so that both pictures align."""
        super().__init__("", parent)
        self._is_above_depth = is_above_depth
        self.setObjectName("image_panel")
        self.setAccessibleName(self.tr("Colour image"))
        self.set_empty_text(self.tr("No colour image yet"))

    def _beside_px(self) -> float:
        return scale_px(self) if self._is_above_depth else 0.0

    def set_image(self, rgb: NDArray[np.uint8] | None) -> None:
        """Show an image (H, W, 3), RGB; None: none."""
        if rgb is None:
            self._image = QImage()
        else:
            shown = np.ascontiguousarray(thinned(rgb, 2 * self.width(), 2 * self.height()))
            height, width, _ = shown.shape
            image = QImage(shown.tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888)
            self._image = image.copy()  # the bytes are gone when this returns
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the image."""
        painter = QPainter(self)
        if self._image.isNull():
            self._paint_empty(painter)
        else:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            place = self._place(self._image.width(), self._image.height())
            painter.drawImage(place, self._image, QRectF(self._image.rect()))
        painter.end()


class DepthPanel(_Panel):
    """A depth image in turbo colours with its scale in metres; a tooltip shows the depth under the mouse."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("", parent)
        self.setObjectName("depth_panel")
        self.setAccessibleName(self.tr("Depth image"))
        self.set_empty_text(self.tr("No depth image yet"))
        self.setMouseTracking(True)
        self._depth_m: NDArray[np.float32] | None = None
        self._range_m = (0.0, 1.0)

    @property
    def range_m(self) -> tuple[float, float]:
        """Depths at the ends of the scale."""
        return self._range_m

    def set_depth(self, depth_m: NDArray[np.float32] | None) -> None:
        """Show depths (H, W) in m; 0 and not finite mean there is none. The array is not copied."""
        self._depth_m = depth_m
        if depth_m is None:
            self._image = QImage()
        else:
            area = self._available()
            shown = thinned(depth_m, area.width(), area.height()).astype(np.float32, copy=False)
            self._range_m = range_of(shown) or self._range_m
            rgba = depth_colors(shown, *self._range_m)
            height, width, _ = rgba.shape
            image = QImage(rgba.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888)
            self._image = image.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
        self.update()

    def depth_at(self, point: QPointF) -> float | None:
        """Return the depth in m under a point of the widget; NaN without a depth, None off the image."""
        if self._depth_m is None:
            return None
        height, width = self._depth_m.shape
        place = self._place(width, height)
        if not place.contains(point):
            return None
        column = min(int((point.x() - place.left()) / place.width() * width), width - 1)
        row = min(int((point.y() - place.top()) / place.height() * height), height - 1)
        depth = float(self._depth_m[row, column])
        return depth if np.isfinite(depth) and depth > 0 else float("nan")

    def describe(self, point: QPointF) -> str:
        """Return the tooltip for a point of the widget."""
        depth = self.depth_at(point)
        if depth is None:
            return self.tr("Depth along the camera's axis, in metres; hatched: no depth")
        if np.isnan(depth):
            return self.tr("no depth here")
        return self.tr("{depth:.3f} m").format(depth=depth)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Show the depth under the mouse."""
        if self.depth_at(event.position()) is not None:
            QToolTip.showText(event.globalPosition().toPoint(), self.describe(event.position()), self)
        else:
            QToolTip.hideText()

    def event(self, event: QEvent) -> bool:
        """Show the depth where the mouse rests."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self.describe(QPointF(event.pos())), self)
            return True
        return super().event(event)

    def _beside_px(self) -> float:
        return scale_px(self)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the depths and their scale."""
        painter = QPainter(self)
        if self._image.isNull() or self._depth_m is None:
            self._paint_empty(painter)
        else:
            place = self._place(self._depth_m.shape[1], self._depth_m.shape[0])
            theme = theme_of(self)
            painter.fillRect(place, theme.color("raised"))
            area = QPainterPath()
            area.addRect(place)
            faint = theme.color("muted")
            faint.setAlphaF(0.4)
            hatch(painter, area, faint)
            painter.drawImage(place, self._image, QRectF(self._image.rect()))
            self._paint_scale(painter, place)
        painter.end()

    def _paint_scale(self, painter: QPainter, place: QRectF) -> None:
        theme = theme_of(self)
        painter.setFont(smaller(self.font()))
        metrics = QFontMetricsF(painter.font())
        half = metrics.height() / 2
        bar = QRectF(place.right() + GRID_PX, place.top() + half, _BAR_PX, place.height() - 2 * half)
        gradient = QLinearGradient(bar.bottomLeft(), bar.topLeft())
        for k in range(17):
            r, g, b = (int(channel) for channel in _TURBO[k * 255 // 16])
            gradient.setColorAt(k / 16, QColor(r, g, b))
        painter.fillRect(bar, gradient)
        low, high = self._range_m
        step = tick_step((high - low) * 2 * metrics.height() / max(bar.height(), 1.0))
        ticks = [k * step for k in range(ceil(low / step - 1e-6), floor(high / step + 1e-6) + 1)]
        decimals = 2 if step >= 0.01 else 3
        for tick in ticks:
            y = bar.bottom() - (tick - low) / (high - low) * bar.height()
            painter.setPen(QPen(theme.color("text"), 1))
            painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 3, y))
            box = QRectF(bar.right() + 5, y - half, self.width() - bar.right() - 5, 2 * half)
            unit = " m" if tick == ticks[-1] else ""
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, f"{tick:.{decimals}f}{unit}")
