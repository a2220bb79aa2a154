"""Hundreds of candies as one surface, of which only the positions change from frame to frame."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.parts import Layer, Paint, Part
from app.gui.views.scene.picking import BallTarget
from app.gui.views.scene.prepared import Float32Array, vertex_normals
from app.gui.views.scene.shapes import ball, merged, octahedron
from core.geometry import BoolArray

_LOST_SIZE = 1.25
"""An octahedron looks smaller than the ball around it."""
_SHAPES = {True: ball, False: octahedron}


class Candies:
    """A layer of candies: kept ones are balls, lost ones octahedra of another colour.

    Attributes:
        layer: to be drawn.
    """

    def __init__(self, n: int, radius_m: float, kept: BoolArray | None) -> None:
        is_kept = np.ones(n, dtype=bool) if kept is None else np.asarray(kept, dtype=bool)
        shapes = [_SHAPES[bool(one)]() for one in is_kept]
        counts = np.array([len(vertices) for vertices, _ in shapes], dtype=np.intp)
        vertices, faces = merged(shapes)
        sizes = np.where(is_kept, radius_m, _LOST_SIZE * radius_m)
        self._candy_of_vertex = np.repeat(np.arange(n), counts)
        self._offsets = (vertices * sizes[self._candy_of_vertex, None]).astype(np.float32)
        indices = faces.astype(np.uint32)
        self._target = BallTarget(np.full((n, 3), np.nan), radius_m)
        part = Part(
            "surface",
            np.full_like(self._offsets, np.nan),
            Paint(("kept", "lost"), which=np.repeat(~is_kept, counts).astype(np.uint8)),
            normals=vertex_normals(self._offsets, indices),
            indices=indices.ravel(),
        )
        self.layer = Layer((part,), self._target)

    def move(self, positions_m: npt.ArrayLike) -> None:
        """Put the candies to positions (n, 3); NaN ones are not shown."""
        positions = np.asarray(positions_m, dtype=float)
        self._target.centers_m = positions
        self.layer.parts[0].move_vertices(self._vertices(positions.astype(np.float32)))

    def _vertices(self, positions_m: Float32Array) -> Float32Array:
        vertices: Float32Array = positions_m[self._candy_of_vertex]
        vertices += self._offsets
        return vertices
