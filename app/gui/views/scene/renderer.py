"""Draws pictures of one view in the drawing thread, and keeps there what the next one needs again."""

from __future__ import annotations

from math import prod

from OpenGL import GL
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem
from PySide6.QtGui import QImage, QMatrix4x4

from app.gui.theme import Theme
from app.gui.views.scene.buffers import PictureBuffer
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.drawing_context import DrawingContext
from app.gui.views.scene.items import DrawnLayer
from app.gui.views.scene.parts import Layer
from app.gui.views.scene.programs import GroundProgram, SurfaceProgram
from app.gui.views.scene.snapshot import Snapshot
from core.geometry import FloatArray

_SAMPLES = 4
_MOST_SMOOTH_TRIANGLES, _MOST_SMOOTH_PIXELS = 40_000, 600_000


class Renderer:
    """Draws snapshots; all its calls belong into the drawing thread.

    Where the processor draws, smooth edges more than double the time a picture takes: there they appear once
    the view has been still for a moment.

    Attributes:
        surface_program: the surfaces' shader.
        ground_program: the ground's.
    """

    surface_program: SurfaceProgram
    ground_program: GroundProgram

    def __init__(self) -> None:
        self._drawn: dict[int, DrawnLayer] = {}
        self._theme: Theme | None = None
        self._pixel_ratio = 0.0
        self._camera = Camera()
        self._model_view, self._projection = QMatrix4x4(), QMatrix4x4()
        self._plain, self._smooth = PictureBuffer(0), PictureBuffer(_SAMPLES)

    def draw(self, context: DrawingContext, snapshot: Snapshot) -> QImage:
        """Return the picture of a snapshot."""
        self.surface_program, self.ground_program = context.surface_program, context.ground_program
        self._follow(snapshot)
        size = snapshot.device_size
        self._plain.bind(size)
        if self._is_to_be_smooth(context, snapshot):
            self._smooth.bind(size)
            self._paint(snapshot)
            self._smooth.copy_to(self._plain)
        else:
            self._paint(snapshot)
        return self._plain.read()

    def release_buffers(self, _: DrawingContext) -> None:
        """Give back what only a view on the screen needs."""
        self._plain.release()
        self._smooth.release()

    def release(self, context: DrawingContext) -> None:
        """Give back everything."""
        self.release_buffers(context)
        self._drop_all()

    # What items ask of their view

    def up_before_eye(self) -> tuple[float, float, float]:
        """The world's z-axis as the eye sees it."""
        x, y, z = self._camera.axes[:, 2]
        return float(x), float(y), float(z)

    def currentModelView(self) -> QMatrix4x4:
        """From the item that is drawn to the eye."""
        return self._model_view

    def currentProjection(self) -> QMatrix4x4:
        """From the eye to the picture."""
        return self._projection

    def update(self) -> None:
        """An item changed: nothing to do, for a picture is drawn only when the view wants one."""

    def _follow(self, snapshot: Snapshot) -> None:
        """Bring the items up to date."""
        if snapshot.pixel_ratio != self._pixel_ratio:  # on another screen now
            self._drop_all()
        for number in self._drawn.keys() - snapshot.layers.keys():
            self._drop(number)
        for number, layer in snapshot.layers.items():
            if number not in self._drawn:
                self._drawn[number] = self._new(layer, snapshot)
            elif snapshot.theme is not self._theme:
                self._drawn[number].take_theme(snapshot.theme)
            self._drawn[number].follow(layer)
        self._theme, self._pixel_ratio = snapshot.theme, snapshot.pixel_ratio
        self._camera = snapshot.camera
        self._rank()

    def _new(self, layer: Layer, snapshot: Snapshot) -> DrawnLayer:
        drawn = DrawnLayer(layer, snapshot.theme, snapshot.pixel_ratio)
        for item in drawn.items:
            item._setView(self)
        return drawn

    def _drop_all(self) -> None:
        for number in tuple(self._drawn):
            self._drop(number)

    def _drop(self, number: int) -> None:
        self._drawn.pop(number).release()

    def _rank(self) -> None:
        """Draw what is see-through from far to near."""
        eye_m = self._camera.eye_m
        layers = sorted(
            self._drawn.values(),
            key=lambda drawn: -drawn.distance_m(eye_m) if drawn.is_see_through else 0.0,
        )
        for rank, drawn in enumerate(layers):
            drawn.take_rank(rank)

    def _is_to_be_smooth(self, context: DrawingContext, snapshot: Snapshot) -> bool:
        """Whether edges are to be smooth; not if the picture would take so long that the view stutters."""
        if not context.is_software:
            return True
        n_triangles = sum(drawn.n_triangles for drawn in self._drawn.values() if drawn.layer.is_visible)
        is_quick = n_triangles <= _MOST_SMOOTH_TRIANGLES and prod(snapshot.device_size) <= _MOST_SMOOTH_PIXELS
        return snapshot.is_still and is_quick

    def _paint(self, snapshot: Snapshot) -> None:
        """Draw the items, into whatever buffer is bound."""
        self._projection = _matrix(snapshot.camera.projection(snapshot.size))
        view = _matrix(snapshot.camera.T_eye_world)
        background = snapshot.theme.color("scene")
        GL.glClearColor(background.redF(), background.greenF(), background.blueF(), 1.0)
        GL.glDepthMask(True)
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT | GL.GL_COLOR_BUFFER_BIT)
        items: list[GLGraphicsItem] = [item for drawn in self._drawn.values() for item in drawn.items]
        for item in sorted(items, key=lambda item: item.depthValue()):
            if item.visible():
                self._model_view = view * item.transform()
                item.paint()


def _matrix(values: FloatArray) -> QMatrix4x4:
    return QMatrix4x4(*(float(value) for value in values.ravel()))
