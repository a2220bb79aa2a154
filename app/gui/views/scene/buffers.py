"""Buffers that pictures are drawn into."""

from __future__ import annotations

import numpy as np
from OpenGL import GL
from PySide6.QtGui import QImage
from PySide6.QtOpenGL import QOpenGLFramebufferObject, QOpenGLFramebufferObjectFormat

from app.gui.views.scene.camera import Size


class PictureBuffer:
    """Colours and depths of a picture, with several samples a pixel or one; kept until the size changes."""

    def __init__(self, n_samples: int) -> None:
        """Prepare; 0 samples: one a pixel, which can be read."""
        self._n_samples = n_samples
        self._buffer: QOpenGLFramebufferObject | None = None

    def bind(self, size: Size) -> None:
        """Draw into it from now on, in the screen's pixels."""
        if self._buffer is None or self._buffer.size().toTuple() != size:
            self._buffer = None  # first, so that never two of them take memory
            form = QOpenGLFramebufferObjectFormat()
            form.setAttachment(QOpenGLFramebufferObject.Attachment.CombinedDepthStencil)
            form.setSamples(self._n_samples)
            self._buffer = QOpenGLFramebufferObject(*size, form)
        self._buffer.bind()
        GL.glViewport(0, 0, *size)

    def copy_to(self, other: PictureBuffer) -> None:
        """Bring the mean of each pixel's samples to another buffer of the same size."""
        source, target = self._bound(), other._bound()
        width, height = source.size().toTuple()
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, source.handle())
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, target.handle())
        GL.glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL.GL_COLOR_BUFFER_BIT, GL.GL_NEAREST)

    def read(self) -> QImage:
        """Return the colours as a picture, when all of it is drawn."""
        buffer = self._bound()
        width, height = buffer.size().toTuple()
        pixels = np.empty((height, width), dtype=np.uint32)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, buffer.handle())
        # Not `toImage`, which would keep the interpreter's lock until the processor has drawn everything.
        GL.glReadPixels(0, 0, width, height, GL.GL_BGRA, GL.GL_UNSIGNED_INT_8_8_8_8_REV, pixels)
        upright = np.ascontiguousarray(pixels[::-1])
        return QImage(upright.data, width, height, 4 * width, QImage.Format.Format_RGB32).copy()

    def release(self) -> None:
        """Give the memory back."""
        self._buffer = None

    def _bound(self) -> QOpenGLFramebufferObject:
        assert self._buffer is not None, "bind first"
        return self._buffer
