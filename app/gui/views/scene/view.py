"""The OpenGL widget of a 3D view: draws layers, turns with the mouse, tells where it was clicked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pyqtgraph.opengl import GLViewWidget
from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QColor, QMatrix4x4, QMouseEvent, QPainter, QSurfaceFormat, QWheelEvent

from app.gui.theme import Theme
from app.gui.views.scene.camera import Camera, Size
from app.gui.views.scene.items import (
    DepthItem,
    PartItem,
    SurfaceItem,
    SurfaceProgram,
    item_of,
    set_colors,
    set_pose,
    set_vertices,
)
from app.gui.views.scene.parts import Layer
from core.geometry import FloatArray, transform_points

_TURN_DEG_PX = 0.35
_ZOOM_STEP = 0.999
_LABEL_GAP_PX = 8


@dataclass(eq=False)
class _Drawn:
    """A layer's items, in the order of its parts."""

    layer: Layer
    items: list[PartItem]
    depth: DepthItem | None
    revisions: list[int]


class SceneView(GLViewWidget):  # type: ignore[misc]  # pyqtgraph has no types
    """Draws layers as a camera sees them.

    Signals:
        turned: the mouse moved the camera.
        pressed, dragged, released: of the left button, in pixels, if `is_handle_at` was true at the press.
        clicked, double_clicked: the left button, in pixels.
    """

    camera_moved = Signal(object)
    pressed = Signal(QPointF)
    dragged = Signal(QPointF)
    released = Signal()
    clicked = Signal(QPointF)
    double_clicked = Signal(QPointF)
    hovered = Signal(QPointF)
