"""Triangles as pyqtgraph's items: one body, or many instances of it that are placed anew for every frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from OpenGL import GL
from OpenGL.GL.ARB.draw_instanced import glDrawElementsInstancedARB
from OpenGL.GL.ARB.instanced_arrays import glVertexAttribDivisorARB
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem
from PySide6.QtOpenGL import QOpenGLBuffer

from app.gui.views.scene.parts import Part
from app.gui.views.scene.programs import COLOR, NORMAL, PLACE, POSITION, TURN
from app.gui.views.scene.states import BACKS, BLENDED, FRONTS, OPAQUE
from core.geometry import AnyArray

_ARRAYS = {"position": ((POSITION, 3, 0),), "normal": ((NORMAL, 3, 0),), "color": ((COLOR, 4, 0),)}
_INSTANCES = {"pose": ((PLACE, 3, 0), (TURN, 4, 12))}
"""By buffer: location, number of floats, and bytes before them."""
_POSE_BYTES = 28


class SurfaceItem(GLGraphicsItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Triangles.

    Attributes:
        part: what is drawn.
    """

    def __init__(self, part: Part) -> None:
        super().__init__()
        self.part = part
        self._buffers: dict[str, QOpenGLBuffer] = {}
        self._colors: AnyArray = np.ones(4, dtype=np.float32)
        self._dirty = {"position", "normal", "index", "color", "pose"}
        opaque = BACKS if part.is_rim else OPAQUE if part.poses is None else FRONTS
        self.setGLOptions(opaque if part.paint.opacity == 1 else BLENDED)

    def take_vertices(self) -> None:
        """Draw the part's vertices, or its instances, as they are now."""
        self._dirty.add("position" if self.part.poses is None else "pose")

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex or instance (N, 4)."""
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
        GL.glUniform1f(program.gloss, self.part.gloss)
        GL.glUniform1f(program.lit, 0.0 if self.part.is_rim else 1.0)
        enabled = self._bind()
        self._draw_triangles()
        for location in enabled:
            if self.part.poses is not None:
                glVertexAttribDivisorARB(location, 0)
            GL.glDisableVertexAttribArray(location)
        GL.glUseProgram(0)

    def _bind(self) -> list[int]:
        """Bind the buffers to the shader's attributes."""
        is_many = self.part.poses is not None
        enabled = []
        for name, attributes in (_ARRAYS | _INSTANCES).items():
            if name not in self._buffers:
                continue
            self._buffers[name].bind()
            for location, n, before in attributes:
                stride = _POSE_BYTES if name in _INSTANCES else 0
                GL.glVertexAttribPointer(location, n, GL.GL_FLOAT, False, stride, GL.GLvoidp(before))
                GL.glEnableVertexAttribArray(location)
                if is_many and name in ("pose", "color"):
                    glVertexAttribDivisorARB(location, 1)
                enabled.append(location)
            self._buffers[name].release()
        if "color" not in self._buffers:
            GL.glVertexAttrib4f(COLOR, *self._colors)
        if not is_many:
            GL.glVertexAttrib3f(PLACE, 0.0, 0.0, 0.0)
            GL.glVertexAttrib4f(TURN, 0.0, 0.0, 0.0, 1.0)
        return enabled

    def _draw_triangles(self) -> None:
        part = self.part
        if part.indices is None:
            GL.glDrawArrays(GL.GL_TRIANGLES, 0, len(part.vertices_m))
            return
        self._buffers["index"].bind()
        n = part.indices.size
        if part.poses is None:
            GL.glDrawElements(GL.GL_TRIANGLES, n, GL.GL_UNSIGNED_INT, None)
        else:
            glDrawElementsInstancedARB(GL.GL_TRIANGLES, n, GL.GL_UNSIGNED_INT, None, len(part.poses))
        self._buffers["index"].release()

    def _upload(self) -> None:
        """Upload what has changed; faces of vertices without a position collapse at the origin."""
        part = self.part
        if "position" in self._dirty:
            self._store("position", np.nan_to_num(part.vertices_m))
        if "normal" in self._dirty and part.normals is not None:
            self._store("normal", part.normals)
        if "index" in self._dirty and part.indices is not None:
            self._store("index", part.indices)
        if "pose" in self._dirty and part.poses is not None:
            self._store("pose", part.poses)
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
        self.setGLOptions(BLENDED)

    def paint(self) -> None:
        """Draw without colours."""
        self.setupGLState()
        GL.glColorMask(False, False, False, False)
        for surface in self._surfaces:
            surface.draw(self.modelViewMatrix() * surface.transform())
        GL.glColorMask(True, True, True, True)
