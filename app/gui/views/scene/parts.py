"""What a layer is made of, before it is drawn: plain arrays and names of colours. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.colors import ColorArray, ColorScale, theme_color
from app.gui.views.scene.picking import Target
from app.gui.views.scene.prepared import Float32Array, UInt32Array
from core.geometry import FloatArray, transform_points

if TYPE_CHECKING:
    from app.gui.theme import Theme

ByteArray = npt.NDArray[np.uint8]

_ENOUGH = 2000
"""Vertices to tell how large something looks."""


@dataclass(frozen=True)
class Paint:
    """How a part gets its colours; names are fields of `Theme`, so that it follows a change of theme.

    Attributes:
        names: of colours; of everything if there is no `which`.
        which: (N,) index of each vertex's name.
        values: (N,) what a scale colours instead; where it is NaN the first name is used.
        scale: of the values.
        opacity: 0 to 1.
    """

    names: tuple[str, ...]
    which: ByteArray | None = None
    values: Float32Array | None = None
    scale: ColorScale | None = None
    opacity: float = 1.0

    def colors(self, theme: Theme) -> ColorArray:
        """Colours, (4,) of all vertices or (N, 4) of each."""
        palette = np.array([theme_color(theme, name) for name in self.names])
        if self.values is not None and self.scale is not None:
            by_value = self.scale.colors(self.values)
            colors = np.where(by_value[:, 3:] > 0, by_value, palette[0])
        else:
            colors = palette[0] if self.which is None else palette[self.which]
        colors = np.array(colors, dtype=np.float32)
        colors[..., 3] *= self.opacity
        return colors


@dataclass(eq=False)
class Part:
    """Something that is drawn at once.

    Attributes:
        kind: `surface` of triangles, `lines` of segments, `points`.
        vertices_m: (N, 3) in the part's own frame.
        paint: its colours.
        normals: (N, 3) of a surface.
        indices: (M,) of the vertices: three for each triangle, two for each segment; None: in their order.
        size_px: width of lines, size of points.
        is_on_top: whether nothing hides it.
        T_layer_part: (4, 4) pose in its layer.
        revision: counts changes of the vertices.
    """

    kind: Literal["surface", "lines", "points"]
    vertices_m: Float32Array
    paint: Paint
    normals: Float32Array | None = None
    indices: UInt32Array | None = None
    size_px: float = 1.0
    is_on_top: bool = False
    T_layer_part: FloatArray = field(default_factory=lambda: np.eye(4))
    revision: int = 0
    _outline: tuple[int, FloatArray] | None = None

    def outline_m(self) -> FloatArray:
        """Vertices (K, 3), so many that the others lie within them but for little; absent ones left out."""
        if self._outline is None or self._outline[0] != self.revision:
            placed = self.vertices_m[np.isfinite(self.vertices_m).all(axis=1)].astype(float)
            self._outline = self.revision, _thinned(placed)
        return self._outline[1]

    @property
    def n_triangles(self) -> int:
        """How many triangles it has."""
        if self.kind != "surface":
            return 0
        return (len(self.vertices_m) if self.indices is None else self.indices.size) // 3

    def move_vertices(self, vertices_m: Float32Array) -> None:
        """Replace all vertices (N, 3) by as many others."""
        self.vertices_m = vertices_m
        self.revision += 1


@dataclass(eq=False)
class Layer:
    """What a page shows under one name.

    Attributes:
        parts: what is drawn.
        target: what a click can meet, in the layer's frame; None if a click goes through.
        text: a label's, shown at the first vertex.
        T_world_layer: (4, 4) its pose.
        is_visible: whether it is shown.
    """

    parts: tuple[Part, ...]
    target: Target | None = None
    text: str = ""
    T_world_layer: FloatArray = field(default_factory=lambda: np.eye(4))
    is_visible: bool = True

    def outline_m(self) -> FloatArray:
        """Points (K, 3) in the world within which it lies, tightly; none if nothing of it has a place."""
        outlines = [
            transform_points(self.T_world_layer @ part.T_layer_part, part.outline_m()) for part in self.parts
        ]
        points: FloatArray = np.vstack([np.empty((0, 3)), *outlines])
        return points


def _thinned(points_m: FloatArray) -> FloatArray:
    """Some of many points (N, 3), with those that lie outermost along the axes."""
    if len(points_m) <= _ENOUGH:
        return points_m
    outermost = [*points_m.argmin(axis=0), *points_m.argmax(axis=0)]
    return np.vstack([points_m[outermost], points_m[:: len(points_m) // _ENOUGH]])
