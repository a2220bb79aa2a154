"""Mouse and keys in a 3D view: they turn, move and enlarge the picture, click, and drag handles."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import QEvent, QObject, QPointF, Qt
from PySide6.QtGui import QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QWidget

_TURN_DEG_PX = 0.35
_ZOOM_PER_STEP = 0.999
_KEY_TURN_DEG = 5.0
_KEY_ZOOM = 0.9
_TURNING_KEYS = {
    Qt.Key.Key_Left: (-_KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Right: (_KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Up: (0.0, _KEY_TURN_DEG),
    Qt.Key.Key_Down: (0.0, -_KEY_TURN_DEG),
}
_ZOOMING_KEYS = {Qt.Key.Key_Plus: _KEY_ZOOM, Qt.Key.Key_Equal: _KEY_ZOOM, Qt.Key.Key_Minus: 1 / _KEY_ZOOM}


class InputReceiver(Protocol):
    """What mouse and keys can do to a view; all places in the view's pixels."""

    def turn(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Turn about the centre."""

    def pan(self, right_px: float, down_px: float) -> None:
        """Move the picture."""

    def zoom(self, factor: float) -> None:
        """Go nearer (below 1) or farther."""

    def click(self, at: QPointF) -> None:
        """Pick."""

    def center_on(self, at: QPointF) -> None:
        """Bring what is there to the centre."""

    def take_handle(self, at: QPointF) -> bool:
        """Whether a handle is there; it is dragged from now on."""

    def drag_handle(self, at: QPointF) -> None:
        """The handle's new place."""

    def drop_handle(self) -> None:
        """The handle stays."""

    def hover(self, at: QPointF) -> None:
        """The mouse is there, no button held."""


class SceneInput(QObject):
    """Turns a widget's events into what its view is to do.

    Left drag turns, middle or shift and left moves, the wheel enlarges, a double click centres. The arrow
    keys turn, plus and minus enlarge.
    """

    def __init__(self, widget: QWidget, receiver: InputReceiver) -> None:
        super().__init__(widget)
        self._receiver = receiver
        self._last = QPointF()
        self._pressed_at: QPointF | None = None
        self._has_handle = False
        widget.setMouseTracking(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the events of mouse and keys, leave all others."""
        if isinstance(event, QWheelEvent):
            self._receiver.zoom(_ZOOM_PER_STEP ** event.angleDelta().y())
            return True
        if isinstance(event, QKeyEvent) and event.type() in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            self._key(event)
            return True
        if not isinstance(event, QMouseEvent):
            return super().eventFilter(watched, event)
        handlers = {
            QEvent.Type.MouseButtonPress: self._press,
            QEvent.Type.MouseMove: self._move,
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
            self._receiver.turn(*_TURNING_KEYS[key])
        elif key in _ZOOMING_KEYS:
            self._receiver.zoom(_ZOOMING_KEYS[key])

    def _press(self, event: QMouseEvent) -> None:
        self._last = event.position()
        if event.button() == Qt.MouseButton.LeftButton:
            self._pressed_at = event.position()
            self._has_handle = self._receiver.take_handle(event.position())

    def _move(self, event: QMouseEvent) -> None:
        step = event.position() - self._last
        self._last = event.position()
        if self._pressed_at is not None and _is_far(self._pressed_at, event.position()):
            self._pressed_at = None
        if self._has_handle:
            self._receiver.drag_handle(event.position())
        elif not event.buttons():
            self._receiver.hover(event.position())
        elif self._pressed_at is None:
            self._look(event, step)

    def _look(self, event: QMouseEvent, step: QPointF) -> None:
        has_shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if event.buttons() == Qt.MouseButton.LeftButton and not has_shift:
            self._receiver.turn(-_TURN_DEG_PX * step.x(), _TURN_DEG_PX * step.y())
        else:
            self._receiver.pan(step.x(), step.y())

    def _release(self, event: QMouseEvent) -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._has_handle:
            self._receiver.drop_handle()
        elif self._pressed_at is not None:
            self._receiver.click(event.position())
        self._has_handle = False
        self._pressed_at = None

    def _double_click(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._receiver.center_on(event.position())


def _is_far(start: QPointF, end: QPointF) -> bool:
    return (end - start).manhattanLength() >= QApplication.startDragDistance()
