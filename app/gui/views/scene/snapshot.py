"""What a 3D view shows at one moment, handed from the window's thread to the one that draws."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

from app.gui.theme import Theme
from app.gui.views.scene.camera import Camera, Size
from app.gui.views.scene.parts import Layer


@dataclass(frozen=True)
class Snapshot:
    """All that one picture is drawn from; nothing of it changes any more.

    Attributes:
        layers: by a number that a view gives each layer it is handed, and never again.
        camera: where they are seen from.
        theme: their colours.
        size: of the view, in Qt's pixels.
        pixel_ratio: how many of the screen's pixels are one of Qt's, each way.
        is_still: whether the view has been at rest for a moment, so that the picture may take longer.
    """

    layers: dict[int, Layer]
    camera: Camera
    theme: Theme
    size: Size
    pixel_ratio: float
    is_still: bool

    @property
    def device_size(self) -> Size:
        """In the screen's pixels."""
        return round(self.size[0] * self.pixel_ratio), round(self.size[1] * self.pixel_ratio)


def frozen(layer: Layer) -> Layer:
    """Return a layer as it is now. Its arrays are shared: who moves something gives it new ones."""
    return replace(layer, parts=tuple(copy(part) for part in layer.parts))
