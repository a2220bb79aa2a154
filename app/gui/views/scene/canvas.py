"""The surface a 3D view draws on: OpenGL, or a sentence where there is none."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication, QImage, QOpenGLContext
from PySide6.QtWidgets import QLabel, QWidget

from app.gui.views.scene.camera import Camera
from app.gui.views.scene.parts import Layer

if TYPE_CHECKING:
    from app.gui.views.scene.view import SceneView


class BlankCanvas(QLabel):
    """A sentence instead of a picture; takes the calls of `SceneView` and does nothing."""

    can_draw = False

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setText(self.tr("No 3D view: this display offers no OpenGL. Everything else works."))
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setWordWrap(True)
        self.setObjectName("no_opengl")

    def put(self, name: str, layer: Layer) -> None:
        """Nothing is shown."""

    def drop(self, name: str) -> None:
        """Nothing was shown."""

    def set_camera(self, camera: Camera) -> None:
        """There is no picture to change."""

    def redraw(self) -> None:
        """There is no picture to change."""

    def grab_image(self) -> QImage:
        """The sentence."""
        return self.grab().toImage()


Canvas: TypeAlias = "SceneView | BlankCanvas"


def make_canvas(parent: QWidget) -> Canvas:
    """Return a surface to draw on, as good as the screen allows."""
    if not has_opengl():
        return BlankCanvas(parent)
    from app.gui.views.scene.view import SceneView  # draws with OpenGL's library, and takes half a second

    return SceneView(parent)


@lru_cache
def has_opengl() -> bool:
    """Whether a widget can draw with OpenGL here; offscreen it could, but crashes when it is grabbed."""
    if QGuiApplication.platformName() in ("offscreen", "minimal"):
        return False
    return QOpenGLContext().create()
