"""The photographed colours of a session's model, for whatever shows its surface. Knows no Qt."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from core.errors import SessionError

if TYPE_CHECKING:
    from app.gui.views.scene import PreparedMesh
    from core.mesh import TriangleMesh
    from core.pipeline.session_view import SessionView


def in_colors(body: PreparedMesh, mesh: TriangleMesh, view: SessionView) -> PreparedMesh:
    """Return a body, prepared from a mesh, in the colours of the session's images if these are its."""
    from core.reconstruction.colors import ModelColors

    if "colors" not in view.records:
        return body
    try:
        rgb = ModelColors.load(view.session.folder("colors")).rgb
    except SessionError:
        return body  # without them it is as good, only grey
    if len(rgb) != len(mesh.vertices_m):
        return body
    return replace(body, rgb=(rgb / 255).astype(np.float32))
