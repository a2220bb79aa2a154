"""Layers as pyqtgraph's items. Surfaces are drawn by our own shader, lit from the eye; needs OpenGL 2.1."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from OpenGL import GL
from OpenGL.GL import shaders
from pyqtgraph import Transform3D
from pyqtgraph.opengl import GLLinePlotItem, GLScatterPlotItem
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem
from PySide6.QtOpenGL import QOpenGLBuffer, QOpenGLFramebufferObject, QOpenGLFramebufferObjectFormat

from app.gui.theme import Theme
from app.gui.views.scene.camera import Size
from app.gui.views.scene.parts import Layer, Part
from core.geometry import AnyArray, FloatArray

_VERTEX = """
#version 120
attribute vec3 a_position;
attribute vec3 a_normal;
attribute vec4 a_color;
uniform mat4 u_eye;
uniform mat4 u_projection;
varying vec3 v_eye;
varying vec3 v_normal;
varying vec4 v_color;
void main() {
    vec4 seen = u_eye * vec4(a_position, 1.0);
    v_eye = seen.xyz;
    v_normal = mat3(u_eye) * a_normal;
    v_color = a_color;
    gl_Position = u_projection * seen;
}
"""
_FRAGMENT = """
#version 120
uniform vec3 u_up;
varying vec3 v_eye;
varying vec3 v_normal;
varying vec4 v_color;
void main() {
    // The face's own normal turns to the eye, however its corners are ordered. Where the smooth normal is far
    // from it there is a crease.
    vec3 face = normalize(cross(dFdx(v_eye), dFdy(v_eye)));
    vec3 smooth_normal = normalize(v_normal);
    float along = dot(face, smooth_normal);
    smooth_normal *= sign(along);
    vec3 normal = normalize(mix(face, smooth_normal, smoothstep(0.82, 0.94, abs(along))));
    float from_eye = max(dot(normal, vec3(-0.19, 0.27, 0.944)), 0.0);
    float from_sky = 0.5 + 0.5 * dot(normal, u_up);
    gl_FragColor = vec4(v_color.rgb * (0.32 + 0.58 * from_eye + 0.16 * from_sky), v_color.a);
}
"""
_POSITION, _NORMAL, _COLOR = 0, 1, 2
_BLENDED = {
    GL.GL_DEPTH_TEST: True,
    GL.GL_BLEND: True,
    GL.GL_CULL_FACE: False,
    "glDepthRange": (0.0, 1.0),
    "glDepthFunc": (GL.GL_LEQUAL,),
    "glBlendFuncSeparate": (GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA, GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA),
}
_OPAQUE = {**_BLENDED, GL.GL_BLEND: False}
_LINES = {**_BLENDED, "glDepthRange": (0.0, 1 - 3e-5)}
"""Lines on a surface are before it: by 1.5 mm when seen from a metre away."""
_ON_TOP = {**_BLENDED, GL.GL_DEPTH_TEST: False}
_RANK_OPAQUE, _RANK_LINES, _RANK_SEE_THROUGH, _RANK_ON_TOP = 0.0, 1.0, 2.0, 1e6
"""The order of drawing."""
_SAMPLES = 4


class SurfaceProgram:
    """The surfaces' shader, compiled for the context that is current."""

    def __init__(self) -> None:
        self.id = shaders.compileProgram(
            shaders.compileShader(_VERTEX.lstrip(), GL.GL_VERTEX_SHADER),
            shaders.compileShader(_FRAGMENT.lstrip(), GL.GL_FRAGMENT_SHADER),
            validate=False,
        )
        for location, name in ((_POSITION, "a_position"), (_NORMAL, "a_normal"), (_COLOR, "a_color")):
            GL.glBindAttribLocation(self.id, location, name)
        GL.glLinkProgram(self.id)
        self.eye = GL.glGetUniformLocation(self.id, "u_eye")
        self.projection = GL.glGetUniformLocation(self.id, "u_projection")
        self.up = GL.glGetUniformLocation(self.id, "u_up")


class SurfaceItem(GLGraphicsItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Triangles."""

    def __init__(self, part: Part) -> None:
        super().__init__()
        self._part = part
        self._buffers: dict[str, QOpenGLBuffer] = {}
        self._colors: AnyArray = np.ones(4, dtype=np.float32)
        self._dirty = {"position", "normal", "index", "color"}
        self.setGLOptions(_OPAQUE if part.paint.opacity == 1 else _BLENDED)

    def initializeGL(self) -> None:
        """Forget the buffers of an earlier context."""
        self._buffers = {}
        self._dirty = {"position", "normal", "index", "color"}

    def take_vertices(self) -> None:
        """Draw the part's vertices as they are now."""
        self._dirty.add("position")

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex (N, 4)."""
        self._colors = colors
        self._dirty.add("color")

    def paint(self) -> None:
        """Draw it in its colours."""
        self.setupGLState()
        self.draw(self.modelViewMatrix())

    def draw(self, eye: Any) -> None:
        """Draw it with a matrix that takes its points before the eye."""
        self._upload()
        program = self.view().surface_program
        GL.glUseProgram(program.id)
        GL.glUniformMatrix4fv(program.eye, 1, False, np.array(eye.data(), dtype=np.float32))
        projection = np.array(self.projectionMatrix().data(), dtype=np.float32)
        GL.glUniformMatrix4fv(program.projection, 1, False, projection)
        GL.glUniform3f(program.up, *self.view().up_before_eye())
        enabled = self._bind()
        self._draw_triangles()
        for location in enabled:
            GL.glDisableVertexAttribArray(location)
        GL.glUseProgram(0)

    def _bind(self) -> list[int]:
        """Bind the buffers to the shader's attributes."""
        sizes = {"position": (_POSITION, 3), "normal": (_NORMAL, 3), "color": (_COLOR, 4)}
        enabled = []
        for name, (location, n) in sizes.items():
            if name not in self._buffers:
                continue
            self._buffers[name].bind()
            GL.glVertexAttribPointer(location, n, GL.GL_FLOAT, False, 0, None)
            self._buffers[name].release()
            GL.glEnableVertexAttribArray(location)
            enabled.append(location)
        if "color" not in self._buffers:
            GL.glVertexAttrib4f(_COLOR, *self._colors)
        return enabled

    def _draw_triangles(self) -> None:
        if self._part.indices is None:
            GL.glDrawArrays(GL.GL_TRIANGLES, 0, len(self._part.vertices_m))
            return
        self._buffers["index"].bind()
        GL.glDrawElements(GL.GL_TRIANGLES, self._part.indices.size, GL.GL_UNSIGNED_INT, None)
        self._buffers["index"].release()

    def _upload(self) -> None:
        """Upload what has changed; faces of vertices without a position collapse at the origin."""
        part = self._part
        if "position" in self._dirty:
            self._store("position", np.nan_to_num(part.vertices_m))
        if "normal" in self._dirty and part.normals is not None:
            self._store("normal", part.normals)
        if "index" in self._dirty and part.indices is not None:
            self._store("index", part.indices)
        if "color" in self._dirty:
            self._buffers.pop("color", None)
            if self._colors.ndim == 2:
                self._store("color", self._colors)
        self._dirty = set()

    def _store(self, name: str, array: AnyArray) -> None:
        kind = QOpenGLBuffer.Type.IndexBuffer if name == "index" else QOpenGLBuffer.Type.VertexBuffer
        buffer = self._buffers.setdefault(name, QOpenGLBuffer(kind))
        if not buffer.isCreated():
            buffer.create()
        data = np.ascontiguousarray(array)
        buffer.bind()
        buffer.allocate(data, data.nbytes)  # type: ignore[call-overload]  # takes any buffer, not only bytes
        buffer.release()


class DepthItem(GLGraphicsItem):  # type: ignore[misc]  # pyqtgraph has no types
    """The depths of see-through surfaces, drawn before them: of each layer one sees the nearest face only."""

    def __init__(self, surfaces: list[SurfaceItem]) -> None:
        super().__init__()
        self._surfaces = surfaces
        self.setGLOptions(_BLENDED)

    def paint(self) -> None:
        """Draw without colours."""
        self.setupGLState()
        GL.glColorMask(False, False, False, False)
        for surface in self._surfaces:
            surface.draw(self.modelViewMatrix() * surface.transform())
        GL.glColorMask(True, True, True, True)


class LineItem(GLLinePlotItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Segments."""

    def __init__(self, part: Part, pixel_ratio: float) -> None:
        super().__init__(width=part.size_px * pixel_ratio, mode="lines", antialias=True)
        self._part = part
        self.setGLOptions(_ON_TOP if part.is_on_top else _LINES)
        self.take_vertices()

    def take_vertices(self) -> None:
        """Draw the part's vertices as they are now."""
        self.setData(pos=self._of_ends(self._part.vertices_m))

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex (N, 4)."""
        self.setData(color=self._of_ends(colors) if colors.ndim == 2 else tuple(colors.tolist()))

    def _of_ends(self, of_vertices: AnyArray) -> AnyArray:
        """What the vertices have (N, ...), for the two ends of each segment (2 S, ...)."""
        return of_vertices if self._part.indices is None else of_vertices[self._part.indices]


class PointItem(GLScatterPlotItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Points."""

    def __init__(self, part: Part, pixel_ratio: float) -> None:
        super().__init__(size=part.size_px * pixel_ratio, pxMode=True)
        self._part = part
        self.setGLOptions(_ON_TOP if part.is_on_top else _LINES)
        self.take_vertices()

    def take_vertices(self) -> None:
        """Draw the part's vertices as they are now."""
        self.setData(pos=self._part.vertices_m)

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex (N, 4)."""
        self.setData(color=colors if colors.ndim == 2 else tuple(colors.tolist()))


PartItem: TypeAlias = SurfaceItem | LineItem | PointItem


def item_of(part: Part, pixel_ratio: float) -> PartItem:
    """Return the item that draws a part, on a screen with so many pixels for one of Qt's."""
    if part.kind == "surface":
        return SurfaceItem(part)
    return LineItem(part, pixel_ratio) if part.kind == "lines" else PointItem(part, pixel_ratio)


class DrawnLayer:
    """Items of a layer.

    Attributes:
        layer: what is drawn.
        n_triangles: how many.
    """

    def __init__(self, layer: Layer, theme: Theme, pixel_ratio: float) -> None:
        self.layer = layer
        self._items = [item_of(part, pixel_ratio) for part in layer.parts]
        self._revisions = [part.revision for part in layer.parts]
        surfaces = [item for item in self._items if isinstance(item, SurfaceItem)]
        self.is_see_through = bool(surfaces) and any(part.paint.opacity < 1 for part in layer.parts)
        self._depth = DepthItem(surfaces) if self.is_see_through else None
        self.n_triangles = sum(part.n_triangles for part in layer.parts)
        self.take_theme(theme)

    @property
    def items(self) -> list[GLGraphicsItem]:
        """Everything to be drawn."""
        return [*self._items, self._depth] if self._depth is not None else self._items

    def take_theme(self, theme: Theme) -> None:
        """Draw in a theme's colours."""
        for item, part in zip(self._items, self.layer.parts, strict=True):
            item.take_colors(part.paint.colors(theme))

    def follow(self) -> None:
        """Bring the items to where and how the layer is now."""
        for item in self.items:
            item.setVisible(self.layer.is_visible)
        if not self.layer.is_visible:
            return
        for k, (item, part) in enumerate(zip(self._items, self.layer.parts, strict=True)):
            item.setTransform(Transform3D(self.layer.T_world_layer @ part.T_layer_part))
            if self._revisions[k] != part.revision:
                item.take_vertices()
                self._revisions[k] = part.revision

    def take_rank(self, rank: int) -> None:
        """Be drawn after see-through layers of lower rank; opaque ones come first anyway."""
        order = {"lines": _RANK_LINES, "points": _RANK_LINES}
        surface = _RANK_SEE_THROUGH + rank + 0.5 if self.is_see_through else _RANK_OPAQUE
        for item, part in zip(self._items, self.layer.parts, strict=True):
            item.setDepthValue(_RANK_ON_TOP if part.is_on_top else order.get(part.kind, surface))
        if self._depth is not None:
            self._depth.setDepthValue(_RANK_SEE_THROUGH + rank)

    def distance_m(self, eye_m: FloatArray) -> float:
        """How far the layer's middle is from the eye."""
        outline = self.layer.outline_m()
        return float(np.linalg.norm(outline.mean(axis=0) - eye_m)) if len(outline) else 0.0


class SmoothBuffer:
    """A multisampled buffer, kept while its view is on the screen: slow to make, and 40 MB large."""

    def __init__(self) -> None:
        self._buffer: QOpenGLFramebufferObject | None = None

    def draw(self, draw: Callable[[], None], size: Size, target: int) -> None:
        """Draw with several samples a pixel and bring their mean to a frame buffer.

        Args:
            draw: draws, whatever it draws on.
            size: in the screen's pixels.
            target: the frame buffer's name; the current one afterwards.
        """
        self.prepare(size)
        buffer = self._buffer
        assert buffer is not None
        buffer.bind()
        draw()
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, buffer.handle())
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, target)
        GL.glBlitFramebuffer(0, 0, *size, 0, 0, *size, GL.GL_COLOR_BUFFER_BIT, GL.GL_NEAREST)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, target)

    def release(self) -> None:
        """Give the memory back; the view's context must be current."""
        self._buffer = None

    def is_ready(self, size: Size) -> bool:
        """Whether drawing needs no preparation."""
        return self._buffer is not None and self._buffer.size().toTuple() == size

    def prepare(self, size: Size) -> None:
        """Do what takes long; the view's context must be current."""
        if self.is_ready(size):
            return
        self.release()
        form = QOpenGLFramebufferObjectFormat()
        form.setAttachment(QOpenGLFramebufferObject.Attachment.CombinedDepthStencil)
        form.setSamples(_SAMPLES)
        self._buffer = QOpenGLFramebufferObject(*size, form)
