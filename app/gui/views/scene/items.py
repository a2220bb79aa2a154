"""Layers as pyqtgraph's items."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from pyqtgraph import Transform3D
from pyqtgraph.opengl import GLLinePlotItem, GLScatterPlotItem
from pyqtgraph.opengl.GLGraphicsItem import GLGraphicsItem

from app.gui.theme import Theme
from app.gui.views.scene.ground import GroundPart
from app.gui.views.scene.ground_item import GroundItem
from app.gui.views.scene.parts import Layer, Part
from app.gui.views.scene.states import LINES, ON_TOP
from app.gui.views.scene.surfaces import DepthItem, SurfaceItem
from core.geometry import AnyArray, FloatArray

_RANK_OPAQUE, _RANK_GROUND, _RANK_LINES, _RANK_SEE_THROUGH, _RANK_ON_TOP = 0.0, 0.5, 1.0, 2.0, 1e6
"""The order of drawing; much of the ground is hidden, and then not drawn."""


class LineItem(GLLinePlotItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Segments.

    Attributes:
        part: what is drawn.
    """

    def __init__(self, part: Part, pixel_ratio: float) -> None:
        super().__init__(width=part.size_px * pixel_ratio, mode="lines", antialias=True)
        self.part = part
        self.setGLOptions(ON_TOP if part.is_on_top else LINES)
        self.take_vertices()

    def take_vertices(self) -> None:
        """Draw the part's vertices as they are now."""
        self.setData(pos=self._of_ends(self.part.vertices_m))

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex (N, 4)."""
        self.setData(color=self._of_ends(colors) if colors.ndim == 2 else tuple(colors.tolist()))

    def _of_ends(self, of_vertices: AnyArray) -> AnyArray:
        """What the vertices have (N, ...), for the two ends of each segment (2 S, ...)."""
        return of_vertices if self.part.indices is None else of_vertices[self.part.indices]


class PointItem(GLScatterPlotItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Points.

    Attributes:
        part: what is drawn.
    """

    def __init__(self, part: Part, pixel_ratio: float) -> None:
        super().__init__(size=part.size_px * pixel_ratio, pxMode=True)
        self.part = part
        self.setGLOptions(ON_TOP if part.is_on_top else LINES)
        self.take_vertices()

    def take_vertices(self) -> None:
        """Draw the part's vertices as they are now."""
        self.setData(pos=self.part.vertices_m)

    def take_colors(self, colors: AnyArray) -> None:
        """Draw in a colour (4,) or in one for each vertex (N, 4)."""
        self.setData(color=colors if colors.ndim == 2 else tuple(colors.tolist()))


PartItem: TypeAlias = SurfaceItem | GroundItem | LineItem | PointItem


def item_of(part: Part, pixel_ratio: float) -> PartItem:
    """Return the item that draws a part, on a screen with so many pixels for one of Qt's."""
    if isinstance(part, GroundPart):
        return GroundItem(part)
    if part.kind == "surface":
        return SurfaceItem(part)
    return LineItem(part, pixel_ratio) if part.kind == "lines" else PointItem(part, pixel_ratio)


class DrawnLayer:
    """Items of a layer.

    Attributes:
        layer: what is drawn, as the view had it when it last asked for a picture.
        is_see_through: whether what is behind it is seen.
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

    def follow(self, layer: Layer) -> None:
        """Bring the items to where and how the layer is now."""
        self.layer = layer
        for item in self.items:
            item.setVisible(layer.is_visible)
        if not layer.is_visible:
            return
        for k, (item, part) in enumerate(zip(self._items, layer.parts, strict=True)):
            item.part = part
            item.setTransform(Transform3D(layer.T_world_layer @ part.T_layer_part))
            if self._revisions[k] != part.revision:
                item.take_vertices()
                self._revisions[k] = part.revision

    def take_rank(self, rank: int) -> None:
        """Be drawn after see-through layers of lower rank; opaque ones come first anyway."""
        order = {"ground": _RANK_GROUND, "lines": _RANK_LINES, "points": _RANK_LINES}
        surface = _RANK_SEE_THROUGH + rank + 0.5 if self.is_see_through else _RANK_OPAQUE
        for item, part in zip(self._items, self.layer.parts, strict=True):
            item.setDepthValue(_RANK_ON_TOP if part.is_on_top else order.get(part.kind, surface))
        if self._depth is not None:
            self._depth.setDepthValue(_RANK_SEE_THROUGH + rank)

    def release(self) -> None:
        """Give back what the items keep in the context."""
        for item in self.items:
            item._setView(None)
            if isinstance(item, GroundItem):
                item.release()

    def distance_m(self, eye_m: FloatArray) -> float:
        """How far the layer's middle is from the eye."""
        outline = self.layer.outline_m()
        return float(np.linalg.norm(outline.mean(axis=0) - eye_m)) if len(outline) else 0.0
