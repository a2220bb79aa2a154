"""The ground as pyqtgraph's item: two triangles, on which the shader draws grid and shadows."""

from __future__ import annotations

import numpy as np
from OpenGL import GL
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem

from app.gui.views.scene.ground import GroundPart
from app.gui.views.scene.programs import POSITION
from app.gui.views.scene.states import FRONTS
from core.geometry import AnyArray


class GroundItem(GLGraphicsItem):  # type: ignore[misc]  # pyqtgraph has no types
    """A ground, seen from above only.

    Attributes:
        part: what is drawn.
    """

    def __init__(self, part: GroundPart) -> None:
        super().__init__()
        self.part = part
        self._colors: AnyArray = np.ones((3, 4), dtype=np.float32)
        self._texture: int | None = None
        self._is_dirty = True
        self.setGLOptions(FRONTS)

    def release(self) -> None:
        """Give the texture back."""
        if self._texture is not None:
            GL.glDeleteTextures([self._texture])
            self._texture = None

    def take_vertices(self) -> None:
        """Draw the shadows as they are now."""
        self._is_dirty = True

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in the colours (3, 4) of plane, lines and background."""
        self._colors = colors

    def paint(self) -> None:
        """Draw it."""
        self.setupGLState()
        part, program = self.part, self.view().ground_program
        GL.glUseProgram(program.id)
        for name, matrix in (("eye", self.modelViewMatrix()), ("projection", self.projectionMatrix())):
            GL.glUniformMatrix4fv(program.at[name], 1, False, np.array(matrix.data(), dtype=np.float32))
        for name, color in zip(("plane", "line", "background"), self._colors, strict=True):
            GL.glUniform3f(program.at[name], *color[:3])
        GL.glUniform2f(program.at["half"], *part.half_m)
        GL.glUniform3f(program.at["middle"], *part.vertices_m.mean(axis=0))
        GL.glUniform1f(program.at["grid"], part.grid_m)
        GL.glUniform1f(program.at["fades"], float(part.fades))
        self._bind_shadow()
        GL.glUniform1i(program.at["shadow"], 0)
        GL.glEnableVertexAttribArray(POSITION)
        GL.glVertexAttribPointer(POSITION, 3, GL.GL_FLOAT, False, 0, part.vertices_m)
        GL.glDrawElements(GL.GL_TRIANGLES, 6, GL.GL_UNSIGNED_INT, part.indices)
        GL.glDisableVertexAttribArray(POSITION)
        GL.glBindTexture(GL.GL_TEXTURE_2D, 0)
        GL.glUseProgram(0)

    def _bind_shadow(self) -> None:
        """Bind the map of shadows, brought up to date."""
        GL.glActiveTexture(GL.GL_TEXTURE0)
        if self._texture is None:
            self._texture = int(GL.glGenTextures(1))
            GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)
            for name in (GL.GL_TEXTURE_MIN_FILTER, GL.GL_TEXTURE_MAG_FILTER):
                GL.glTexParameteri(GL.GL_TEXTURE_2D, name, GL.GL_LINEAR)
            for name in (GL.GL_TEXTURE_WRAP_S, GL.GL_TEXTURE_WRAP_T):
                GL.glTexParameteri(GL.GL_TEXTURE_2D, name, GL.GL_CLAMP_TO_EDGE)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)
        if not self._is_dirty:
            return
        shadow = np.ascontiguousarray(self.part.shadow)
        rows, columns = shadow.shape  # a multiple of four bytes, as OpenGL expects
        GL.glTexImage2D(
            GL.GL_TEXTURE_2D,
            0,
            GL.GL_LUMINANCE8,
            columns,
            rows,
            0,
            GL.GL_LUMINANCE,
            GL.GL_UNSIGNED_BYTE,
            shadow,
        )
        self._is_dirty = False
