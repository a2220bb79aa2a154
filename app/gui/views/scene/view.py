"""The OpenGL widget of a 3D view: draws layers as a camera sees them."""

from __future__ import annotations

from math import prod
from typing import Any

from OpenGL import GL
from pyqtgraph.opengl import GLViewWidget
from PySide6.QtCore import QTimer
from PySide6.QtGui import QHideEvent, QImage, QMatrix4x4, QPainter
from PySide6.QtOpenGL import QOpenGLPaintDevice
from PySide6.QtWidgets import QWidget

from app.gui.theme import Theme
from app.gui.views.scene.camera import Camera, Size
from app.gui.views.scene.items import DrawnLayer
from app.gui.views.scene.overlay import paint_labels
from app.gui.views.scene.parts import Layer
from app.gui.views.scene.programs import GroundProgram, SurfaceProgram
from app.gui.views.scene.smooth import SmoothBuffer
from core.geometry import FloatArray

_STILL_MS = 300
_MOST_SMOOTH_TRIANGLES, _MOST_SMOOTH_PIXELS = 40_000, 600_000
_SOFTWARE = (b"llvmpipe", b"softpipe", b"swrast", b"SwiftShader")


class SceneView(GLViewWidget):  # type: ignore[misc]  # pyqtgraph has no types
    """Draws the layers it is given, and only when something changed.

    Where the processor draws, smooth edges more than double the time a picture takes: there they appear once
    the view has been still for a moment.

    Attributes:
        can_draw: always.
        surface_program: the surfaces' shader in this view's context.
        ground_program: the ground's.
    """

    can_draw = True

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        self._camera = Camera()
        self._theme = theme
        self._drawn: dict[str, DrawnLayer] = {}
        self._is_following = True
        self._is_still = False
        self._is_software = True
        self._smooth = SmoothBuffer()
        super().__init__(parent)
        self._stillness = QTimer(self, singleShot=True, interval=_STILL_MS)
        self._stillness.timeout.connect(self._paint_smooth)
        self._is_following = False
        self.setObjectName("gl_view")
        self.set_theme(theme)

    def put(self, name: str, layer: Layer) -> None:
        """Draw a layer from now on, instead of the one that had its name."""
        self.drop(name)
        drawn = DrawnLayer(layer, self._theme, self.devicePixelRatioF())
        self._drawn[name] = drawn
        for item in drawn.items:
            self.addItem(item)

    def drop(self, name: str) -> None:
        """Draw a layer no more."""
        if name in self._drawn:
            for item in self._drawn.pop(name).items:
                self.removeItem(item)

    def set_camera(self, camera: Camera) -> None:
        """See from elsewhere."""
        self._camera = camera
        self.update()

    def set_theme(self, theme: Theme) -> None:
        """Draw everything in another theme's colours."""
        self._theme = theme
        self.setBackgroundColor(theme.scene)
        for drawn in self._drawn.values():
            drawn.take_theme(theme)

    def grab_image(self) -> QImage:
        """The picture as it is now, with smooth edges."""
        self._is_still = True
        image: QImage = self.grabFramebuffer()
        return image

    def up_before_eye(self) -> tuple[float, float, float]:
        """The world's z-axis as the eye sees it."""
        x, y, z = self._camera.axes[:, 2]
        return float(x), float(y), float(z)

    def update(self) -> None:
        """Paint soon; but not because painting itself brings the items up to date."""
        if not self._is_following:
            self._is_still = False
            self._stillness.start()
            super().update()

    def initializeGL(self) -> None:
        """Compile for this context; it may be a second one, if the widget was moved to another window."""
        self.surface_program, self.ground_program = SurfaceProgram(), GroundProgram()
        self._smooth = SmoothBuffer()
        self._is_software = any(word in GL.glGetString(GL.GL_RENDERER) for word in _SOFTWARE)
        super().initializeGL()
        for item in self.items:
            item.initializeGL()

    def hideEvent(self, event: QHideEvent) -> None:
        """Give back what only a view on the screen needs."""
        if self.isValid():
            self.makeCurrent()
            self._smooth.release()
            self.doneCurrent()
        super().hideEvent(event)

    def projectionMatrix(self, region: Any, viewport: Any) -> QMatrix4x4:
        """Ours instead of pyqtgraph's."""
        del region, viewport
        return _matrix(self._camera.projection((self.width(), self.height())))

    def viewMatrix(self) -> QMatrix4x4:
        """Ours instead of pyqtgraph's."""
        return _matrix(self._camera.T_eye_world)

    def paintGL(self) -> None:
        """Draw the layers as they are now, then the labels."""
        self._is_following = True
        try:
            for drawn in self._drawn.values():
                drawn.follow()
            self._rank()
        finally:
            self._is_following = False
        if self._is_to_be_smooth():
            self._smooth.draw(super().paintGL, self._device_size(), self.defaultFramebufferObject())
        else:
            super().paintGL()
        self._paint_labels()

    def _paint_smooth(self) -> None:
        """Prepare and draw in two steps, so that between them the window can answer."""
        if not self.isVisible() or not self.isValid():
            return
        if self._smooth.is_ready(self._device_size()):
            self._is_still = True
            super().update()
            return
        self.makeCurrent()
        self._smooth.prepare(self._device_size())
        self.doneCurrent()
        self._stillness.start()

    def _device_size(self) -> Size:
        return self.deviceWidth(), self.deviceHeight()

    def _rank(self) -> None:
        """Draw what is see-through from far to near."""
        eye_m = self._camera.eye_m
        layers = sorted(
            self._drawn.values(),
            key=lambda drawn: -drawn.distance_m(eye_m) if drawn.is_see_through else 0.0,
        )
        for rank, drawn in enumerate(layers):
            drawn.take_rank(rank)

    def _is_to_be_smooth(self) -> bool:
        """Whether edges are to be smooth; not if the picture would take so long that the window stutters."""
        if not self._is_software:
            return True
        n_triangles = sum(drawn.n_triangles for drawn in self._drawn.values() if drawn.layer.is_visible)
        is_quick = n_triangles <= _MOST_SMOOTH_TRIANGLES and prod(self._device_size()) <= _MOST_SMOOTH_PIXELS
        return self._is_still and is_quick

    def _paint_labels(self) -> None:
        layers = [
            drawn.layer for drawn in self._drawn.values() if drawn.layer.text and drawn.layer.is_visible
        ]
        if not layers:
            return
        # Not on the widget itself: `QWidget.grab` redirects such a painter away from what is grabbed.
        device = QOpenGLPaintDevice(*self._device_size())
        device.setDevicePixelRatio(self.devicePixelRatioF())
        painter = QPainter(device)
        painter.setFont(self.font())
        paint_labels(painter, layers, self._theme, self._camera, (self.width(), self.height()))
        painter.end()


def _matrix(values: FloatArray) -> QMatrix4x4:
    return QMatrix4x4(*(float(value) for value in values.ravel()))
