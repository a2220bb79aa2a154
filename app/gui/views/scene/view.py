"""The widget of a 3D view: shows the newest picture that the drawing thread made of its layers."""

from __future__ import annotations

from functools import partial
from itertools import count

from PySide6.QtCore import QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QImage, QPainter, QPaintEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QWidget
from shiboken6 import isValid
from typing_extensions import override

from app.gui.theme import theme_of
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.drawing_thread import drawing_thread
from app.gui.views.scene.overlay import paint_labels
from app.gui.views.scene.parts import Layer
from app.gui.views.scene.renderer import Renderer
from app.gui.views.scene.snapshot import Snapshot, frozen

_STILL_MS = 300


class SceneView(QWidget):
    """Shows the layers it is given. A picture is drawn when something changed, at most one at a time.

    Attributes:
        can_draw: always.

    Signals: `painted` when a new picture is on the screen.
    """

    can_draw = True
    painted = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("gl_view")
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self._thread = drawing_thread()
        self._renderer = Renderer()
        self.destroyed.connect(partial(_release, self._renderer))
        self._camera = Camera()
        self._numbers = count()
        self._layers: dict[str, tuple[int, Layer]] = {}
        self._picture: tuple[QImage, Snapshot] | None = None
        self._is_new = False
        self._is_changed, self._is_still = True, False
        self._is_being_drawn = False
        self._stillness = QTimer(self, singleShot=True, interval=_STILL_MS)
        self._stillness.timeout.connect(self._rest)
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self._ask)

    def put(self, name: str, layer: Layer) -> None:
        """Draw a layer from now on, instead of the one that had its name."""
        self._layers[name] = next(self._numbers), layer
        self.redraw()

    def drop(self, name: str) -> None:
        """Draw a layer no more."""
        if self._layers.pop(name, None) is not None:
            self.redraw()

    def set_camera(self, camera: Camera) -> None:
        """See from elsewhere."""
        self._camera = camera
        self.redraw()

    def redraw(self) -> None:
        """Have a new picture drawn soon: something else is to be seen."""
        self._is_changed, self._is_still = True, False
        self._stillness.start()
        if not self._is_being_drawn:
            self._soon.start()  # a page changes many layers one after the other

    def grab_image(self) -> QImage:
        """The picture as it is now, with smooth edges; waits until it is drawn."""
        snapshot = self._snapshot(is_still=True)
        image = self._thread.run(partial(self._renderer.draw, snapshot=snapshot)).result()
        image.setDevicePixelRatio(snapshot.pixel_ratio)
        painter = QPainter(image)
        self._paint_labels(painter, snapshot)
        painter.end()
        image.setDevicePixelRatio(1.0)
        return image

    @override
    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.redraw()

    @override
    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._picture = None
        self._thread.run(self._renderer.release_buffers)

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.redraw()

    @override
    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(event.rect(), theme_of(self).color("scene"))
        if self._picture is not None:
            image, snapshot = self._picture
            # Where the view has another size by now the picture stays in its middle until the next one comes.
            width, height = snapshot.size
            painter.translate(QPointF((self.width() - width) // 2, (self.height() - height) // 2))
            image.setDevicePixelRatio(snapshot.pixel_ratio)
            painter.drawImage(QPointF(0, 0), image)
            self._paint_labels(painter, snapshot)
        painter.end()
        if self._is_new:
            self._is_new = False
            self.painted.emit()

    def _rest(self) -> None:
        """Nothing has changed for a moment: there is time for smooth edges."""
        self._is_changed = self._is_still = True
        self._ask()

    def _ask(self) -> None:
        """Have a picture drawn, if it would be seen and none is being drawn; else it follows that one."""
        if not self.isVisible() or self._is_being_drawn or not self._is_changed:
            return
        self._is_changed, self._is_being_drawn = False, True
        snapshot = self._snapshot(self._is_still)
        self._thread.run_then(
            partial(self._renderer.draw, snapshot=snapshot), partial(self._take, snapshot=snapshot)
        )

    def _take(self, image: QImage, snapshot: Snapshot) -> None:
        if not isValid(self):
            return
        self._is_being_drawn = False
        if self.isVisible():
            self._picture, self._is_new = (image, snapshot), True
            self.update()
        if self._is_changed:
            self._soon.start()

    def _snapshot(self, is_still: bool) -> Snapshot:
        size = max(self.width(), 1), max(self.height(), 1)
        layers = {number: frozen(layer) for number, layer in self._layers.values()}
        return Snapshot(layers, self._camera, theme_of(self), size, self.devicePixelRatioF(), is_still)

    def _paint_labels(self, painter: QPainter, snapshot: Snapshot) -> None:
        layers = [layer for layer in snapshot.layers.values() if layer.text and layer.is_visible]
        if layers:
            painter.setFont(self.font())
            paint_labels(painter, layers, snapshot.theme, snapshot.camera, snapshot.size)


def _release(renderer: Renderer) -> None:
    drawing_thread().run(renderer.release)
