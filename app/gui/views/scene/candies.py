"""Candies as a layer: one shape, drawn wherever the physics left one of them, as it lies there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.parts import Float32Array, Layer, Paint, Part, PreparedMesh, prepare_mesh
from app.gui.views.scene.picking import BallTarget
from app.gui.views.scene.shapes import Shape
from core.geometry import BoolArray

if TYPE_CHECKING:
    from app.gui.theme import Theme

CANDY_COLORS = ("#2468c8", "#2f9a4a", "#f0bf2a", "#6e4327", "#58b4e0")
"""Of kept ones, each has one of them; no red, which is STOP's, and no orange, the lost ones' rim."""
LOST_COLOR = "#bdbab3"
"""Of lost ones: without a hue, and with a rim around it."""
_RIM = 0.075
"""Width of the rim, as a share of the candy's diameter."""
_GLOSS = 0.28
_SEED = 5


class Candies:
    """A layer of candies: kept ones are colourful, lost ones grey with a coloured rim.

    Attributes:
        layer: to be drawn.
        radius_m: half of a candy's largest extent.
    """

    def __init__(self, n: int, shape: Shape, kept: BoolArray | None) -> None:
        """Make n candies of a shape about its centre; `kept` (n,): which ones stayed, None: all."""
        is_kept = np.ones(n, dtype=bool) if kept is None else np.asarray(kept, dtype=bool)
        body = prepare_mesh(*shape)
        radius_m = float(np.linalg.norm(body.vertices_m, axis=1).max())
        self.radius_m = radius_m
        self._lost = np.flatnonzero(~is_kept)
        self._target = BallTarget(np.full((n, 3), np.nan), radius_m)
        which = np.random.default_rng(_SEED).integers(0, len(CANDY_COLORS), n)
        which[self._lost] = len(CANDY_COLORS)
        paint = Paint((*CANDY_COLORS, LOST_COLOR), which=which.astype(np.uint8))
        self._bodies = _part(body, paint, n)
        rim_m = body.vertices_m + 2 * _RIM * radius_m * body.normals
        self._rims = _part(
            PreparedMesh(rim_m, body.normals, body.faces), Paint(("lost",)), len(self._lost), is_rim=True
        )
        self.layer = Layer((self._bodies, self._rims) if len(self._lost) else (self._bodies,), self._target)

    def move(self, positions_m: npt.ArrayLike, quaternions: npt.ArrayLike) -> None:
        """Put the candies to positions (n, 3), turned by (n, 4), (x, y, z, w); NaN ones are not shown."""
        positions = np.asarray(positions_m, dtype=float)
        self._target.centers_m = positions
        poses = np.column_stack([positions, _unit(np.asarray(quaternions, dtype=float))])
        poses[~np.isfinite(positions).all(axis=1)] = 0
        placed: Float32Array = poses.astype(np.float32)
        self._bodies.move_instances(placed)
        self._rims.move_instances(placed[self._lost])


def candy_legend(theme: Theme, kept: str, lost: str) -> str:
    """Return rich text with the looks of kept and lost candies before what is said of them."""
    dots = "".join(f'<span style="color:{color}">●</span>' for color in CANDY_COLORS[:3])
    return f'{dots} {kept} &nbsp; <span style="color:{theme.lost}">◯</span> {lost}'


def _part(body: PreparedMesh, paint: Paint, n: int, is_rim: bool = False) -> Part:
    """N instances of a body, none of them anywhere yet."""
    return Part(
        "surface",
        body.vertices_m,
        paint,
        body.normals,
        body.faces.ravel(),
        poses=np.zeros((n, 7), dtype=np.float32),
        gloss=0.0 if is_rim else _GLOSS,
        is_rim=is_rim,
    )


def _unit(quaternions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Quaternions (n, 4) of length one; the identity for one without a length."""
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    turned: npt.NDArray[np.float64] = np.where(
        length > 0, quaternions / np.maximum(length, 1e-9), (0.0, 0.0, 0.0, 1.0)
    )
    return turned
