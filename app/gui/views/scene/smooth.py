"""Smooth edges: a picture drawn with several samples a pixel."""

from __future__ import annotations

from collections.abc import Callable

from OpenGL import GL
from PySide6.QtOpenGL import QOpenGLFramebufferObject, QOpenGLFramebufferObjectFormat

from app.gui.views.scene.camera import Size

_SAMPLES = 4


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
