"""A layer as it is drawn: its parts' items, kept to what the layer is."""

from __future__ import annotations

import numpy as np
from pyqtgraph import Transform3D
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem

from app.gui.theme import Theme
from app.gui.views.scene.items import DepthItem, SurfaceItem, item_of
from app.gui.views.scene.parts import Layer
from core.geometry import FloatArray

_OPAQUE, _LINES, _SEE_THROUGH, _ON_TOP = 0.0, 1.0, 2.0, 1e6
"""The order of drawing."""


class DrawnLayer:
    """Items of a layer.

    Attributes:
        layer: what is drawn.
        n_triangles: how many.
    """

    def __init__(self, layer: Layer, theme: Theme, pixel_ratio: float) -> None:
        self.layer = layer
        self._items = [item_of(part, pixel_ratio) for part in layer.parts]
        self._revisions = [part.revision for part in layer.parts]
        surfaces = [item for item in self._items if isinstance(item, SurfaceItem)]
        self.is_see_through = bool(surfaces) and any(part.paint.opacity < 1 for part in layer.parts)
        self._depth = DepthItem(surfaces) if self.is_see_through else None
        self.n_triangles = sum(part.n_triangles for part in layer.parts)
        self.take_theme(theme)

    @property
    def items(self) -> list[GLGraphicsItem]:
        """Everything to be drawn."""
        return [*self._items, self._depth] if self._depth is not None else self._items

    def take_theme(self, theme: Theme) -> None:
        """Draw in a theme's colours."""
        for item, part in zip(self._items, self.layer.parts, strict=True):
            item.take_colors(part.paint.colors(theme))

    def follow(self) -> None:
        """Bring the items to where and how the layer is now."""
        for item in self.items:
            item.setVisible(self.layer.is_visible)
        if not self.layer.is_visible:
            return
        for k, (item, part) in enumerate(zip(self._items, self.layer.parts, strict=True)):
            item.setTransform(Transform3D(self.layer.T_world_layer @ part.T_layer_part))
            if self._revisions[k] != part.revision:
                item.take_vertices()
                self._revisions[k] = part.revision

    def take_rank(self, rank: int) -> None:
        """Be drawn after see-through layers of lower rank; opaque ones come first anyway."""
        order = {"lines": _LINES, "points": _LINES}
        surface = _SEE_THROUGH + rank + 0.5 if self.is_see_through else _OPAQUE
        for item, part in zip(self._items, self.layer.parts, strict=True):
            item.setDepthValue(_ON_TOP if part.is_on_top else order.get(part.kind, surface))
        if self._depth is not None:
            self._depth.setDepthValue(_SEE_THROUGH + rank)

    def distance_m(self, eye_m: FloatArray) -> float:
        """How far the layer's middle is from the eye."""
        outline = self.layer.outline_m()
        return float(np.linalg.norm(outline.mean(axis=0) - eye_m)) if len(outline) else 0.0
