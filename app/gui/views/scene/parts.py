"""What a layer is made of before it is drawn: arrays, colour scales, and names of the theme's colours."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.color_scale import TURBO, VIRIDIS, color_table
from app.gui.views.scene.occlusion import ambient_light
from app.gui.views.scene.picking import Target
from core.geometry import AnyArray, FloatArray, transform_points

if TYPE_CHECKING:
    from app.gui.theme import Theme

ByteArray = npt.NDArray[np.uint8]
Float32Array = npt.NDArray[np.float32]
UInt32Array = npt.NDArray[np.uint32]
ColorArray = Float32Array

_MAPS = {"viridis": VIRIDIS, "turbo": TURBO}
_STEPS = 256
_ENOUGH = 2000
"""Vertices that show well enough how large something looks."""


@dataclass(frozen=True)
class ColorScale:
    """The colour of each value.

    Attributes:
        label: what is shown, such as `Height`.
        unit: of the values, as people read it.
        low: value at the scale's one end; what is below has the same colour.
        high: value at its other end.
        colormap: `viridis` or `turbo`.
    """

    label: str
    unit: str
    low: float
    high: float
    colormap: Literal["viridis", "turbo"] = "viridis"

    def colors(self, values: npt.ArrayLike) -> ColorArray:
        """Colours (N, 4), red to opacity in 0 to 1, of values (N,); NaN becomes fully transparent."""
        numbers = np.asarray(values, dtype=float)
        span = self.high - self.low
        share = (numbers - self.low) / span if span > 0 else np.zeros_like(numbers)
        step = np.nan_to_num(np.clip(share, 0, 1) * (_STEPS - 1), nan=_STEPS).round().astype(np.intp)
        colors: ColorArray = _table(self.colormap)[step]
        return colors


@lru_cache
def _table(colormap: str) -> ColorArray:
    """The map's colours (257, 4); the last one, transparent, is for what has no value."""
    opaque = np.column_stack([color_table(_MAPS[colormap], _STEPS) / 255, np.ones(_STEPS)])
    return np.vstack([opaque, np.zeros(4)]).astype(np.float32)


@dataclass(frozen=True)
class PreparedMesh:
    """Arrays to be drawn as they are.

    Attributes:
        vertices_m: (N, 3).
        normals: (N, 3) unit vectors, smooth; the shader makes creases sharp.
        faces: (F, 3) of vertex indices.
        edges: (E, 2) of vertex indices when it is a wire frame, otherwise None.
        values: (N,) the quantity that is coloured; NaN where it is unknown.
        scale: the colours of the values.
        light: (N,) share of the light from around that reaches each vertex; None: all of it.
        rgb: (N, 3) colour of each vertex, 0 to 1, instead of the one it is drawn in; None: it has none.
    """

    vertices_m: Float32Array
    normals: Float32Array
    faces: UInt32Array
    edges: UInt32Array | None = None
    values: Float32Array | None = None
    scale: ColorScale | None = None
    light: Float32Array | None = None
    rgb: Float32Array | None = None


def prepare_mesh(
    vertices_m: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    values: npt.ArrayLike | None = None,
    scale: ColorScale | None = None,
    is_wireframe: bool = False,
    is_shaded: bool = False,
) -> PreparedMesh:
    """Do what takes time before a mesh can be drawn: 200,000 faces take some 40 ms, shaded half a second.

    Args:
        vertices_m: (N, 3).
        faces: (F, 3) of vertex indices.
        values: (N,) a number per vertex, shown by `scale`; NaN where nothing is known.
        scale: the colours of the values.
        is_wireframe: whether only its edges are to be drawn.
        is_shaded: whether its hollows are to be darker; not for the window's thread.
    """
    points = np.ascontiguousarray(vertices_m, dtype=np.float32).reshape(-1, 3)
    triangles = np.ascontiguousarray(faces, dtype=np.uint32).reshape(-1, 3)
    return PreparedMesh(
        vertices_m=points,
        normals=vertex_normals(points, triangles),
        faces=triangles,
        edges=_edges(triangles) if is_wireframe else None,
        values=None if values is None else np.asarray(values, dtype=np.float32),
        scale=scale,
        light=ambient_light(points, triangles) if is_shaded else None,
    )


def vertex_normals(vertices_m: Float32Array, faces: UInt32Array) -> Float32Array:
    """Unit normals (N, 3) of the vertices, the adjacent faces' weighted by their area."""
    index = faces.astype(np.intp)
    a, b, c = (vertices_m[index[:, k]] for k in range(3))
    area = _cross(b - a, c - a)
    normals = np.empty((len(vertices_m), 3), dtype=np.float32)
    for axis in range(3):
        weights = area[:, axis]
        normals[:, axis] = sum(np.bincount(index[:, k], weights, minlength=len(vertices_m)) for k in range(3))
    length = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    normals /= np.maximum(length, np.finfo(np.float32).tiny)[:, None]
    return normals


def _edges(faces: UInt32Array) -> UInt32Array:
    """Each edge (E, 2) once."""
    pairs = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1).astype(
        np.uint64
    )
    keys = np.unique(pairs[:, 0] << np.uint64(32) | pairs[:, 1])
    return np.column_stack([keys >> np.uint64(32), keys & np.uint64(0xFFFFFFFF)]).astype(np.uint32)


def _cross(u: AnyArray, v: AnyArray) -> AnyArray:
    """Cross product (N, 3); numpy's own takes twice as long."""
    product = np.empty_like(u)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        product[:, k] = u[:, i] * v[:, j] - u[:, j] * v[:, i]
    return product


@dataclass(frozen=True)
class Paint:
    """How a part gets its colours; names are fields of `Theme`, so that it follows a change of theme.

    Attributes:
        names: of colours, or `#rrggbb` of what has a colour of its own; of everything if there is no `which`.
        which: (N,) index of each vertex's, or instance's, name.
        values: (N,) what a scale colours instead; where it is NaN the first name is used.
        scale: of the values.
        opacity: 0 to 1.
        light: (N,) share of the colour that is seen; None: all of it.
        rgb: (N, 3) what the vertices have for their own, 0 to 1; values come before it.
    """

    names: tuple[str, ...]
    which: ByteArray | None = None
    values: Float32Array | None = None
    scale: ColorScale | None = None
    opacity: float = 1.0
    light: Float32Array | None = None
    rgb: Float32Array | None = None

    def colors(self, theme: Theme) -> ColorArray:
        """Colours, (4,) of all vertices or (N, 4) of each."""
        palette = np.array([theme.color(name).getRgbF() for name in self.names], dtype=np.float32)
        if self.values is not None and self.scale is not None:
            by_value = self.scale.colors(self.values)
            colors = np.where(by_value[:, 3:] > 0, by_value, palette[0])
        elif self.rgb is not None:
            colors = np.column_stack([self.rgb, np.ones(len(self.rgb), dtype=np.float32)])
        else:
            colors = palette[0] if self.which is None else palette[self.which]
        if self.light is not None:
            colors = np.broadcast_to(colors, (len(self.light), 4))
        colors = np.array(colors, dtype=np.float32)
        colors[..., 3] *= self.opacity
        if self.light is not None:
            colors[:, :3] *= self.light[:, None]
        return colors


@dataclass(eq=False)
class Part:
    """Something that is drawn at once.

    Attributes:
        kind: `surface` of triangles, `ground`, `lines` of segments, `points`.
        vertices_m: (N, 3) in the part's own frame.
        paint: its colours.
        normals: (N, 3) of a surface.
        indices: (M,) of the vertices: three for each triangle, two for each segment; None: in their order.
        poses: (K, 7) position in m and unit quaternion (x, y, z, w) of each instance of an indexed, closed
            surface whose faces are counter-clockwise from outside; zeros for an absent one. None: it is
            drawn once, where it is.
        size_px: width of lines, size of points.
        gloss: how much a surface shines, 0 to 1.
        is_rim: whether only the faces that turn away are drawn, unlit: a rim around what is in it.
        is_on_top: whether nothing hides it.
        T_layer_part: (4, 4) pose in its layer.
        revision: counts changes of the vertices.
    """

    kind: Literal["surface", "ground", "lines", "points"]
    vertices_m: Float32Array
    paint: Paint
    normals: Float32Array | None = None
    indices: UInt32Array | None = None
    poses: Float32Array | None = None
    size_px: float = 1.0
    gloss: float = 0.0
    is_rim: bool = False
    is_on_top: bool = False
    T_layer_part: FloatArray = field(default_factory=lambda: np.eye(4))
    revision: int = 0
    _outlines: dict[int, FloatArray] = field(default_factory=dict)
    """The newest one by its revision, shared with copies of this part."""

    def outline_m(self) -> FloatArray:
        """Vertices (K, 3), so many that the others lie within them but for little; absent ones left out."""
        outline = self._outlines.get(self.revision)
        if outline is None:
            placed = self.vertices_m[np.isfinite(self.vertices_m).all(axis=1)].astype(float)
            if self.poses is not None:
                placed = _around(self.poses[self.poses[:, 3:].any(axis=1), :3], placed)
            outline = _thinned(placed)
            self._outlines.clear()
            self._outlines[self.revision] = outline
        return outline

    @property
    def n_triangles(self) -> int:
        """How many triangles it has."""
        if self.kind != "surface":
            return 0
        n_each = (len(self.vertices_m) if self.indices is None else self.indices.size) // 3
        return n_each if self.poses is None else n_each * len(self.poses)

    def move_vertices(self, vertices_m: Float32Array) -> None:
        """Replace all vertices (N, 3) by as many others."""
        self.vertices_m = vertices_m
        self.revision += 1

    def move_instances(self, poses: Float32Array) -> None:
        """Replace the poses (K, 7) of all instances."""
        self.poses = poses
        self.revision += 1


@dataclass(eq=False)
class Layer:
    """What a page shows under one name.

    Attributes:
        parts: what is drawn.
        target: what a click can hit, in the layer's frame; None if a click goes through.
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


def _around(places_m: Float32Array, body_m: FloatArray) -> FloatArray:
    """Lower and upper corners (2 N, 3) of cubes that hold a body (V, 3), however turned, at each place."""
    reach_m = float(np.linalg.norm(body_m, axis=1).max(initial=0.0))
    return np.vstack([places_m - reach_m, places_m + reach_m]).astype(float)


def _thinned(points_m: FloatArray) -> FloatArray:
    """Some of many points (N, 3), with those that lie outermost along the axes."""
    if len(points_m) <= _ENOUGH:
        return points_m
    outermost = [*points_m.argmin(axis=0), *points_m.argmax(axis=0)]
    return np.vstack([points_m[outermost], points_m[:: len(points_m) // _ENOUGH]])
