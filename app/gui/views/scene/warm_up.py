"""Drawing each kind of thing once where nobody sees it: the first page need not wait for its shaders."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtWidgets import QWidget

from app.gui.views.scene.scene3d import Scene3D
from app.gui.views.scene.shapes import box_mesh

_SIDE_PX = 32
_CORNERS = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def warm_up(parent: QWidget) -> Iterator[None]:
    """Draw step by step, so that between two steps the window can answer; compiled is for all views."""
    scene = Scene3D(parent)
    scene.setFixedSize(_SIDE_PX, _SIDE_PX)
    scene.grab_image()
    yield
    scene.set_points("points", _CORNERS)
    scene.grab_image()
    yield
    scene.set_line("line", _CORNERS)
    scene.grab_image()
    yield
    scene.set_mesh("mesh", *box_mesh(*_CORNERS))
    scene.set_label("label", _CORNERS[0], "0")
    scene.grab_image()
    yield
    scene.deleteLater()
