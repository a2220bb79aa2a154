"""The surface a 3D view draws on: OpenGL, or a sentence where there is none."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication, QImage, QOpenGLContext
from PySide6.QtWidgets import QLabel, QWidget

from app.gui.theme import Theme
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.parts import Layer


class Canvas(Protocol):
    """Something that shows layers.

    Attributes:
        widget: on the screen.
        can_draw: whether there is more to see than a sentence.
    """

    widget: QWidget
    can_draw: bool

    def put(self, name: str, layer: Layer) -> None:
        """Show a layer, instead of the one that had its name."""

    def drop(self, name: str) -> None:
        """Show a layer no more."""

    def set_camera(self, camera: Camera) -> None:
        """See from elsewhere."""

    def set_theme(self, theme: Theme) -> None:
        """Change the colours."""

    def update(self) -> None:
        """Show what changed since, soon."""

    def grab_image(self) -> QImage:
        """The picture as it is now."""


def make_canvas(theme: Theme, parent: QWidget) -> Canvas:
    """Return a surface to draw on, as good as the screen allows."""
    if not has_opengl():
        return BlankCanvas(parent)
    from app.gui.views.scene.view import SceneView  # needs OpenGL's library, and takes half a second

    return SceneView(theme, parent)


def has_opengl() -> bool:
    """Whether a widget can draw with OpenGL here; offscreen it could, but crashes when it is grabbed."""
    if QGuiApplication.platformName() in ("offscreen", "minimal"):
        return False
    return QOpenGLContext().create()


class BlankCanvas:
    """A sentence instead of a picture."""

    can_draw = False

    def __init__(self, parent: QWidget) -> None:
        label = QLabel(parent.tr("No 3D view: this display offers no OpenGL. Everything else works."), parent)
        label.setAlignment(Qt.AlignmentFlag.AlignCenter)
        label.setWordWrap(True)
        label.setObjectName("no_opengl")
        self.widget: QWidget = label

    def put(self, name: str, layer: Layer) -> None:
        """Nothing is shown."""

    def drop(self, name: str) -> None:
        """Nothing was shown."""

    def set_camera(self, camera: Camera) -> None:
        """Nothing is seen."""

    def set_theme(self, theme: Theme) -> None:
        """The sentence follows the palette by itself."""

    def update(self) -> None:
        """Nothing changes."""

    def grab_image(self) -> QImage:
        """The sentence."""
        return self.widget.grab().toImage()
