"""The OpenGL context of the drawing thread, and what all views share in it."""

from __future__ import annotations

from OpenGL import GL
from PySide6.QtGui import QOffscreenSurface, QOpenGLContext

from app.gui.views.scene.programs import GroundProgram, SurfaceProgram

_SOFTWARE = (b"llvmpipe", b"softpipe", b"swrast", b"SwiftShader")


class DrawingContext:
    """A current context with its shaders; to be made and used in one thread.

    Attributes:
        surface_program: the surfaces' shader.
        ground_program: the ground's.
        is_software: whether the processor draws.
    """

    def __init__(self, surface: QOffscreenSurface) -> None:
        """Make a context current on a surface."""
        self._context = QOpenGLContext()
        self._context.create()
        self._context.makeCurrent(surface)
        self.surface_program, self.ground_program = SurfaceProgram(), GroundProgram()
        self.is_software = any(word in GL.glGetString(GL.GL_RENDERER) for word in _SOFTWARE)

    def close(self) -> None:
        """Let go of the thread; what is in the context goes with it."""
        self._context.doneCurrent()
