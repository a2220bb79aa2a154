"""Where a 3D view is seen from, and what mouse and keys do in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from PySide6.QtCore import QEasingCurve, QEvent, QObject, QPointF, Qt, QTimer, QVariantAnimation, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication

from app.gui.views.scene.camera import Camera, Ray, Size
from app.gui.views.scene.canvas import Canvas
from app.gui.views.scene.layers import CropBox
from app.gui.views.scene.parts import Layer
from core.geometry import invert_pose

_TURN_DEG_PX = 0.35
_ZOOM_PER_STEP = 0.999
_KEY_TURN_DEG = 5.0
_KEY_ZOOM = 0.9
_EASE_MS = 900
_TURNING_KEYS = {
    Qt.Key.Key_Left: (-_KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Right: (_KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Up: (0.0, _KEY_TURN_DEG),
    Qt.Key.Key_Down: (0.0, -_KEY_TURN_DEG),
}
_ZOOMING_KEYS = {Qt.Key.Key_Plus: _KEY_ZOOM, Qt.Key.Key_Equal: _KEY_ZOOM, Qt.Key.Key_Minus: 1 / _KEY_ZOOM}


class Navigator(QObject):
    """Moves the camera, picks, and drags the handles of boxes.

    Left drag turns, middle or shift and left moves, the wheel goes to the mouse, a double click centres. The
    arrow keys turn, plus and minus enlarge. Layers are fitted into view until the user moves: when one of
    them appears and when the view's size changes.

    Signals:
        picked: layer and index of what a click met.
        box_edited: layer, lower and upper corner of a box whose handle was dropped.
        azimuth_changed: of the camera, in degrees.
        moved: the camera, wherever it is now.
    """

    picked = Signal(str, int)
    box_edited = Signal(str, object, object)
    azimuth_changed = Signal(float)
    moved = Signal(object)

    def __init__(self, canvas: Canvas, layers: Mapping[str, Layer], boxes: Mapping[str, CropBox]) -> None:
        super().__init__(canvas)
        self.camera = Camera()
        self._canvas = canvas
        self._layers = layers
        self._boxes = boxes
        self._dragged: tuple[str, int] | None = None
        self._fitted: tuple[str, ...] = ()
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self.refit)
        self._stays_fitted = True
        self._easing = QVariantAnimation(self, startValue=0.0, endValue=1.0, duration=_EASE_MS)
        self._easing.setEasingCurve(QEasingCurve.Type.InOutCubic)
        self._easing.valueChanged.connect(self._take_ease)
        self._ease_step: Callable[[float], None] = lambda _: None
        self._last = QPointF()
        self._pressed_at: QPointF | None = None
        canvas.setMouseTracking(True)
        canvas.installEventFilter(self)

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

    def ease(self, names: tuple[str, ...]) -> None:
        """Bring layers into view as `fit` does, but as a move that the eye can follow."""
        self._fitted = names
        target = self._fitting_camera() if self._stays_fitted else None
        if target is None:
            return
        start = self.camera
        self._easing.stop()
        self._ease_step = lambda share: self._move(start.blended(target, share))
        self._easing.start()

    def _take_ease(self, share: float) -> None:
        if self._stays_fitted:
            self._ease_step(share)

    def follow(self, camera: Camera) -> None:
        """Look as another view does, which decides from now on what is in view."""
        if camera != self.camera:
            self._stays_fitted = False
            self._move(camera)

    def fit_whatever_comes(self) -> None:
        """Bring into view all layers that are set from now on."""
        self._fitted = ()
        self._stays_fitted = True

    def take_notice(self, name: str) -> None:
        """A layer appeared."""
        if not self._fitted or name in self._fitted:
            self._soon.start()  # a page sets many layers one after the other

    def refit(self) -> None:
        """Bring into view what is to stay in view."""
        camera = self._fitting_camera() if self._stays_fitted else None
        if camera is not None:
            self._easing.stop()
            self._move(camera)

    def _fitting_camera(self) -> Camera | None:
        """From the same side, with all that is to stay in view; none if there is nothing."""
        names = self._fitted or tuple(self._layers)
        layers = [self._layers[name] for name in names if name in self._layers]
        points = np.vstack([np.empty((0, 3)), *(layer.outline_m() for layer in layers if layer.is_visible)])
        return self.camera.fitted(points, self._size()) if len(points) else None

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the events of mouse and keys, leave all others."""
        if isinstance(event, QWheelEvent):
            at, factor = event.position(), _ZOOM_PER_STEP ** event.angleDelta().y()
            self._change(self.camera.zoomed_at(factor, (at.x(), at.y()), self._size()))
            return True
        if isinstance(event, QKeyEvent) and event.type() in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            self._key(event)
            return True
        if not isinstance(event, QMouseEvent):
            return super().eventFilter(watched, event)
        handlers = {
            QEvent.Type.MouseButtonPress: self._press,
            QEvent.Type.MouseMove: self._follow,
            QEvent.Type.MouseButtonRelease: self._release,
            QEvent.Type.MouseButtonDblClick: self._double_click,
        }
        handlers[event.type()](event)
        return True

    def _key(self, event: QKeyEvent) -> None:
        """Turn and enlarge when a key is pressed; leave other keys to the page."""
        key = Qt.Key(event.key())
        event.setAccepted(key in _TURNING_KEYS or key in _ZOOMING_KEYS)
        if event.type() == QEvent.Type.KeyRelease:
            return
        if key in _TURNING_KEYS:
            self._turn(*_TURNING_KEYS[key])
        elif key in _ZOOMING_KEYS:
            self._zoom(_ZOOMING_KEYS[key])

    def _press(self, event: QMouseEvent) -> None:
        self._last = event.position()
        if event.button() == Qt.MouseButton.LeftButton:
            self._pressed_at = event.position()
            self._dragged = self._handle(event.position())

    def _follow(self, event: QMouseEvent) -> None:
        step = event.position() - self._last
        self._last = event.position()
        if self._pressed_at is not None and _is_far(self._pressed_at, event.position()):
            self._pressed_at = None
        if self._dragged is not None:
            self._drag(*self._dragged, event.position())
        elif not event.buttons():
            self._hover(event.position())
        elif self._pressed_at is None:
            self._look(event, step)

    def _look(self, event: QMouseEvent, step: QPointF) -> None:
        has_shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if event.buttons() == Qt.MouseButton.LeftButton and not has_shift:
            self._turn(-_TURN_DEG_PX * step.x(), _TURN_DEG_PX * step.y())
        else:
            self._change(self.camera.panned(step.x(), step.y(), self._size()))

    def _release(self, event: QMouseEvent) -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._dragged is not None:
            self._drop_handle()
        elif self._pressed_at is not None:
            self._pick(event.position())
        self._pressed_at = None

    def _pick(self, at: QPointF) -> None:
        hit = self._hit(self._ray(at))
        if hit is not None:
            self.picked.emit(hit[1], hit[2])

    def _double_click(self, event: QMouseEvent) -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        ray = self._ray(event.position())
        hit = self._hit(ray)
        if hit is not None:
            self._change(self.camera.centered(ray.at(hit[0])))

    def _turn(self, azimuth_deg: float, elevation_deg: float) -> None:
        self._change(self.camera.turned(azimuth_deg, elevation_deg))
        self.azimuth_changed.emit(self.camera.azimuth_deg)

    def _zoom(self, factor: float) -> None:
        self._change(self.camera.zoomed(factor))

    def _change(self, camera: Camera) -> None:
        """Move the camera for the user, who decides from now on what is in view."""
        self._stays_fitted = False
        self._move(camera)

    def _drag(self, name: str, handle: int, at: QPointF) -> None:
        """Move the side of a box, if the box is still there."""
        if name in self._boxes:
            box = self._boxes[name]
            box.drag(handle, self._ray(at).transformed(invert_pose(box.layer.T_world_layer)))
            self._canvas.redraw()

    def _drop_handle(self) -> None:
        dragged, self._dragged = self._dragged, None
        if dragged is not None and dragged[0] in self._boxes:
            box = self._boxes[dragged[0]]
            self.box_edited.emit(dragged[0], box.min_m.copy(), box.max_m.copy())

    def _hover(self, at: QPointF) -> None:
        """Show by the cursor that there is a handle."""
        if self._handle(at) is not None:
            self._canvas.setCursor(Qt.CursorShape.SizeAllCursor)
        else:
            self._canvas.unsetCursor()

    def _move(self, camera: Camera) -> None:
        self.camera = camera
        self._canvas.set_camera(camera)
        self.moved.emit(camera)

    def _size(self) -> Size:
        return max(self._canvas.width(), 1), max(self._canvas.height(), 1)

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


def _is_far(start: QPointF, end: QPointF) -> bool:
    return (end - start).manhattanLength() >= QApplication.startDragDistance()
