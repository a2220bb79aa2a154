"""What lies over a 3D view: labels, the colour scale, and the buttons that choose the viewpoint."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QLinearGradient, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QSizePolicy, QWidget

from app.gui.theme import GRID_PX, Theme, theme_of
from app.gui.views.scene.camera import Camera, Size
from app.gui.views.scene.parts import ColorScale, Layer
from core.geometry import transform_points

_N_TICKS = 5
_BAR_PX = 14
_LABEL_GAP_PX = 10
_LABEL_MARGIN_PX = 4
_LABEL_ALPHA = 0.85


class ViewButtons(QWidget):
    """Iso, top, front, side, and fit.

    Signals:
        viewpoint_chosen: one of `camera.DIRECTIONS`.
        fitted: everything is to be brought into view.
    """

    viewpoint_chosen = Signal(str)
    fitted = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX // 2)
        words = {
            "iso": (self.tr("Iso"), self.tr("Look from above at an angle")),
            "top": (self.tr("Top"), self.tr("Look straight down; y points up")),
            "front": (self.tr("Front"), self.tr("Look along y")),
            "side": (self.tr("Side"), self.tr("Look along −x")),
        }
        for direction, (text, tip) in words.items():
            button = self._button(text, tip, direction)
            button.clicked.connect(lambda _=False, direction=direction: self.viewpoint_chosen.emit(direction))
            row.addWidget(button)
        fit = self._button(self.tr("Fit"), self.tr("Bring everything into view"), "fit")
        fit.clicked.connect(lambda: self.fitted.emit())
        row.addWidget(fit)

    def _button(self, text: str, tip: str, name: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(f"view_{name}")
        button.setAccessibleName(tip)
        button.setToolTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        button.setFixedWidth(button.fontMetrics().horizontalAdvance(text) + 3 * GRID_PX)
        return button


class ScaleLegend(QWidget):
    """A colour scale with numbers and unit."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("scale_legend")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._scale: ColorScale | None = None

    def show_scale(self, scale: ColorScale | None) -> None:
        """Show a scale, or nothing."""
        self._scale = scale
        self.setVisible(scale is not None)
        if scale is not None:
            self.setAccessibleName(f"{scale.label} {' '.join(tick_texts(scale))} {scale.unit}")
            self.resize(self.sizeHint())
            self.update()

    def sizeHint(self) -> QSize:
        """As wide as its words."""
        if self._scale is None:
            return QSize()
        metrics = self.fontMetrics()
        numbers = max(metrics.horizontalAdvance(text) for text in tick_texts(self._scale))
        title = metrics.horizontalAdvance(self._title())
        width = max(title, _BAR_PX + GRID_PX + numbers) + 2 * GRID_PX
        return QSize(width, 22 * GRID_PX)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the title, the bar and its numbers."""
        if self._scale is None:
            return
        theme = theme_of(self)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        background = theme.color("surface")
        background.setAlphaF(0.88)
        painter.setBrush(background)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.drawRoundedRect(self.rect(), 4, 4)
        painter.setPen(theme.color("text"))
        line = painter.fontMetrics().height()
        inside = QRectF(self.rect()).adjusted(GRID_PX, GRID_PX / 2, -GRID_PX, -GRID_PX)
        painter.drawText(inside, Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft, self._title())
        bar = QRectF(inside.left(), inside.top() + 1.6 * line, _BAR_PX, inside.height() - 2.0 * line)
        painter.fillRect(bar, self._gradient(bar))
        self._paint_numbers(painter, bar, line)

    def _paint_numbers(self, painter: QPainter, bar: QRectF, line: int) -> None:
        assert self._scale is not None
        for k, text in enumerate(tick_texts(self._scale)):
            y = bar.bottom() - bar.height() * k / (_N_TICKS - 1)
            box = QRectF(bar.right() + GRID_PX, y - line / 2, self.width(), line)
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, text)

    def _gradient(self, bar: QRectF) -> QLinearGradient:
        assert self._scale is not None
        gradient = QLinearGradient(bar.bottomLeft(), bar.topLeft())
        shares = np.linspace(0, 1, 17)
        values = self._scale.low + shares * (self._scale.high - self._scale.low)
        for share, color in zip(shares, self._scale.colors(values), strict=True):
            gradient.setColorAt(float(share), QColor.fromRgbF(*(float(part) for part in color[:3])))
        return gradient

    def _title(self) -> str:
        if self._scale is None:
            return ""
        return f"{self._scale.label} ({self._scale.unit})" if self._scale.unit else self._scale.label


def tick_texts(scale: ColorScale) -> list[str]:
    """The numbers beside a scale, from the lowest; with enough decimals to distinguish them."""
    step = (scale.high - scale.low) / (_N_TICKS - 1)
    decimals = max(0, 1 - floor(log10(step))) if step > 0 else 0
    texts = [f"{scale.low + k * step:.{decimals}f}" for k in range(_N_TICKS)]
    if decimals and all(text.endswith("0") for text in texts):
        texts = [text[:-1].rstrip(".") for text in texts]
    return texts


def paint_labels(
    painter: QPainter, layers: Sequence[Layer], theme: Theme, camera: Camera, size: Size
) -> None:
    """Paint the texts of layers beside their points, moved so far that they are within the view."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    places = [transform_points(layer.T_world_layer, layer.parts[0].vertices_m[:1]) for layer in layers]
    pixels = camera.project(np.vstack(places), size)
    for layer, (x, y) in zip(layers, pixels, strict=True):
        if 0 <= x <= size[0] and 0 <= y <= size[1]:
            _paint_label(painter, layer.text, QPointF(x, y), theme, size)


def _paint_label(painter: QPainter, text: str, at: QPointF, theme: Theme, size: Size) -> None:
    metrics = painter.fontMetrics()
    box = QRectF(
        0, 0, metrics.horizontalAdvance(text) + 2 * _LABEL_MARGIN_PX, metrics.height() + _LABEL_MARGIN_PX
    )
    box.moveBottomLeft(at + QPointF(_LABEL_GAP_PX, -_LABEL_GAP_PX))
    if box.right() > size[0]:
        box.moveRight(at.x() - _LABEL_GAP_PX)
    if box.top() < 0:
        box.moveTop(at.y() + _LABEL_GAP_PX)
    background = theme.color("surface")
    background.setAlphaF(_LABEL_ALPHA)
    painter.setPen(QPen(theme.color("muted"), 1))
    painter.drawLine(at, box.center())
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(background)
    painter.drawRoundedRect(box, 3, 3)
    painter.setPen(theme.color("text"))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
