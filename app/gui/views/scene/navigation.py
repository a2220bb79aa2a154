"""Where a 3D view is seen from, and what the mouse and the keys do in it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal

from app.gui.views.scene.camera import Camera, Ray, Size
from app.gui.views.scene.canvas import Canvas
from app.gui.views.scene.crop_box import CropBox
from app.gui.views.scene.input import SceneInput
from app.gui.views.scene.parts import Layer
from core.geometry import invert_pose


class Navigator(QObject):
    """Moves the camera, picks, and drags the handles of boxes.

    It fits layers into view until the user moves: when one of them appears and when the view's size changes.

    Signals:
        picked: layer and index of what a click met.
        box_edited: layer, lower and upper corner of a box whose handle was dropped.
        azimuth_changed: of the camera, in degrees.
    """

    picked = Signal(str, int)
    box_edited = Signal(str, object, object)
    azimuth_changed = Signal(float)

    def __init__(self, canvas: Canvas, layers: Mapping[str, Layer], boxes: Mapping[str, CropBox]) -> None:
        super().__init__(canvas.widget)
        self.camera = Camera()
        self._canvas = canvas
        self._layers = layers
        self._boxes = boxes
        self._dragged: tuple[str, int] | None = None
        self._fitted: tuple[str, ...] = ()
        self._soon = QTimer(self)
        self._soon.setSingleShot(True)
        self._soon.setInterval(0)
        self._soon.timeout.connect(self.refit)
        self._stays_fitted = True
        self._input = SceneInput(canvas.widget, self)

    def look_from(self, direction: str) -> None:
        """Look from one of `DIRECTIONS`."""
        self._move(self.camera.looking_from(direction))
        self.azimuth_changed.emit(self.camera.azimuth_deg)
        self.refit()

    def fit(self, names: tuple[str, ...]) -> None:
        """Bring layers into view; none named: all there are now."""
        self._fitted = names or tuple(self._layers)
        self._stays_fitted = True
        self.refit()

    def fit_whatever_comes(self) -> None:
        """Bring into view all layers that will be set."""
        self._fitted = ()
        self._stays_fitted = True

    def take_notice(self, name: str) -> None:
        """A layer appeared."""
        if not self._fitted or name in self._fitted:
            self._soon.start()  # a page sets many layers one after the other

    def refit(self) -> None:
        """Bring into view what is to stay in view."""
        if not self._stays_fitted:
            return
        names = self._fitted or tuple(self._layers)
        layers = [self._layers[name] for name in names if name in self._layers]
        points = np.vstack([np.empty((0, 3)), *(layer.outline_m() for layer in layers if layer.is_visible)])
        if len(points):
            self._move(self.camera.fitted(points, self._size()))

    # What `SceneInput` tells

    def turn(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Turn about the centre."""
        self._stays_fitted = False
        self._move(self.camera.turned(azimuth_deg, elevation_deg))
        self.azimuth_changed.emit(self.camera.azimuth_deg)

    def pan(self, right_px: float, down_px: float) -> None:
        """Move the picture."""
        self._stays_fitted = False
        self._move(self.camera.panned(right_px, down_px, self._size()))

    def zoom(self, factor: float) -> None:
        """Go nearer (below 1) or farther."""
        self._stays_fitted = False
        self._move(self.camera.zoomed(factor))

    def click(self, at: QPointF) -> None:
        """Tell what is there."""
        hit = self._hit(self._ray(at))
        if hit is not None:
            self.picked.emit(hit[1], hit[2])

    def center_on(self, at: QPointF) -> None:
        """Bring what is there to the centre."""
        ray = self._ray(at)
        hit = self._hit(ray)
        if hit is not None:
            self._stays_fitted = False
            self._move(self.camera.centered(ray.at(hit[0])))

    def take_handle(self, at: QPointF) -> bool:
        """Whether a box's handle is there; it is dragged from now on."""
        self._dragged = self._handle(at)
        return self._dragged is not None

    def drag_handle(self, at: QPointF) -> None:
        """Move the side of the box whose handle was taken, if the box is still there."""
        if self._dragged is None or self._dragged[0] not in self._boxes:
            return
        name, handle = self._dragged
        box = self._boxes[name]
        box.drag(handle, self._ray(at).transformed(invert_pose(box.layer.T_world_layer)))
        self._canvas.update()

    def drop_handle(self) -> None:
        """Tell the box as it is now."""
        dragged, self._dragged = self._dragged, None
        if dragged is not None and dragged[0] in self._boxes:
            box = self._boxes[dragged[0]]
            self.box_edited.emit(dragged[0], box.min_m.copy(), box.max_m.copy())

    def hover(self, at: QPointF) -> None:
        """Show by the cursor that there is a handle."""
        if self._handle(at) is not None:
            self._canvas.widget.setCursor(Qt.CursorShape.SizeAllCursor)
        else:
            self._canvas.widget.unsetCursor()

    def _move(self, camera: Camera) -> None:
        self.camera = camera
        self._canvas.set_camera(camera)

    def _size(self) -> Size:
        widget = self._canvas.widget
        return max(widget.width(), 1), max(widget.height(), 1)

    def _ray(self, at: QPointF) -> Ray:
        return self.camera.ray((at.x(), at.y()), self._size())

    def _hit(self, ray: Ray) -> tuple[float, str, int] | None:
        """Distance, layer and index of the first thing on a line of sight."""
        hits = []
        for name, layer in self._layers.items():
            if layer.is_visible and layer.target is not None:
                met = layer.target.hit(ray.transformed(invert_pose(layer.T_world_layer)))
                if met is not None:
                    hits.append((met[0], name, met[1]))
        return min(hits, default=None)

    def _handle(self, at: QPointF) -> tuple[str, int] | None:
        for name, box in self._boxes.items():
            handle = box.handle_at((at.x(), at.y()), self.camera, self._size())
            if handle is not None:
                return name, handle
        return None
