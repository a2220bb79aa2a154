"""OpenGL's state for each kind of thing, as pyqtgraph's items take it."""

from __future__ import annotations

from OpenGL import GL

BLENDED = {
    GL.GL_DEPTH_TEST: True,
    GL.GL_BLEND: True,
    GL.GL_CULL_FACE: False,
    "glDepthRange": (0.0, 1.0),
    "glDepthFunc": (GL.GL_LEQUAL,),
    "glBlendFuncSeparate": (GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA, GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA),
}
OPAQUE = {**BLENDED, GL.GL_BLEND: False}
FRONTS = {**OPAQUE, GL.GL_CULL_FACE: True, "glCullFace": (GL.GL_BACK,)}
"""Only faces that turn to the eye, counter-clockwise from there: of a closed body one sees no others."""
BACKS = {**OPAQUE, GL.GL_CULL_FACE: True, "glCullFace": (GL.GL_FRONT,)}
"""Only faces that turn away: of a body around another one sees a rim."""
LINES = {**BLENDED, "glDepthRange": (0.0, 1 - 3e-5)}
"""Lines on a surface are before it: by 1.5 mm when seen from a metre away."""
ON_TOP = {**BLENDED, GL.GL_DEPTH_TEST: False}
