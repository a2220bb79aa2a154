"""Words in a 3D view: painted flat, over the picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPen

from app.gui.theme import Theme
from app.gui.views.scene.camera import Camera, Size
from app.gui.views.scene.parts import Layer
from core.geometry import FloatArray, transform_points

_GAP_PX = 10
_MARGIN_PX = 4
_ALPHA = 0.85


def paint_labels(
    painter: QPainter, layers: Sequence[Layer], theme: Theme, camera: Camera, size: Size
) -> None:
    """Paint the texts of layers beside their points, moved so far that they are within the view."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    pixels = camera.project(np.vstack([_place(layer) for layer in layers]), size)
    for layer, (x, y) in zip(layers, pixels, strict=True):
        if 0 <= x <= size[0] and 0 <= y <= size[1]:
            _paint(painter, layer.text, QPointF(x, y), theme, size)


def _paint(painter: QPainter, text: str, at: QPointF, theme: Theme, size: Size) -> None:
    metrics = painter.fontMetrics()
    box = QRectF(0, 0, metrics.horizontalAdvance(text) + 2 * _MARGIN_PX, metrics.height() + _MARGIN_PX)
    box.moveBottomLeft(at + QPointF(_GAP_PX, -_GAP_PX))
    if box.right() > size[0]:
        box.moveRight(at.x() - _GAP_PX)
    if box.top() < 0:
        box.moveTop(at.y() + _GAP_PX)
    background = theme.color("surface")
    background.setAlphaF(_ALPHA)
    painter.setPen(QPen(theme.color("muted"), 1))
    painter.drawLine(at, box.center())
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(background)
    painter.drawRoundedRect(box, 3, 3)
    painter.setPen(theme.color("text"))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _place(layer: Layer) -> FloatArray:
    return transform_points(layer.T_world_layer, layer.parts[0].vertices_m[:1])
