"""The ground under things: a plane with a grid, and the soft shadows of what stands or lies on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.parts import ByteArray, Layer, Paint, Part
from core.geometry import AnyArray, BoolArray, FloatArray

_N_CELLS = 192
"""Of the map of shadows, each way."""
_GAP_M = 0.0004
"""Below the height given, so that the underside of what stands there does not flicker through it."""
_BANDS = ((0.004, 0.004, 0.34), (0.02, 0.012, 0.28), (0.08, 0.035, 0.22), (0.25, 0.08, 0.14))
"""Up to a height, how far the shadow is spread, and how dark it is."""
_CANDY_BAND_M, _CANDY_SPREAD_M, _CANDY_DARKNESS = 0.02, 0.002, 0.42
_DISC = np.vstack(
    [
        (0.0, 0.0),
        *(
            r * np.column_stack([np.cos(a), np.sin(a)])
            for r, a in (
                (0.4, np.pi * np.arange(6) / 3),
                (0.8, np.pi * np.arange(12) / 6),
            )
        ),
    ]
)
"""Points (n, 2) that fill a unit disc."""


@dataclass(eq=False)
class GroundPart(Part):
    """The plane, as it is drawn.

    Attributes:
        half_m: (2,) half its sides.
        grid_m: between two lines; every fifth is stronger. 0: none.
        fades: whether it fades into the background towards its rim, or ends there.
        light: gives the share (R, R) of the light that reaches the ground; rows along y.
    """

    half_m: FloatArray = field(default_factory=lambda: np.ones(2))
    grid_m: float = 0.0
    fades: bool = True
    light: Callable[[], FloatArray] = lambda: np.ones((_N_CELLS, _N_CELLS))

    @property
    def shadow(self) -> ByteArray:
        """Darkness (R, R), 0 to 255; found anew each time, which takes some ms, by the thread that draws."""
        darkness: ByteArray = np.rint(255 * (1 - self.light())).astype(np.uint8)
        return darkness

    def outline_m(self) -> FloatArray:
        """Nothing: a view is fitted to what is on the ground."""
        return np.empty((0, 3))


class Ground:
    """A layer that is a ground.

    Attributes:
        layer: to be drawn.
    """

    def __init__(
        self,
        center_m: npt.ArrayLike,
        half_m: npt.ArrayLike,
        casters_m: AnyArray,
        *,
        grid_m: float,
        fades: bool,
        color: str = "ground",
    ) -> None:
        """Make a ground about a point (3,) on it; `casters_m` (N, 3) are points of what stands there."""
        self._center_m = np.asarray(center_m, dtype=float)
        half = np.asarray(half_m, dtype=float)
        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * (*half, 0.0)
        self._part = GroundPart(
            "ground",
            (corners + self._center_m - (0, 0, _GAP_M)).astype(np.float32),
            Paint((color, "grid", "scene"), which=np.arange(3, dtype=np.uint8)),
            indices=np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32),
            half_m=half,
            grid_m=grid_m,
            fades=fades,
        )
        self._clear = self._light_beside(np.asarray(casters_m, dtype=float))
        self._show(lambda: self._clear)
        self.layer = Layer((self._part,))

    def shade_candies(self, positions_m: AnyArray, radius_m: float) -> None:
        """Add the shadows of candies at (n, 3) that lie on it, NaN: absent."""
        self._show(partial(self._light_between, np.array(positions_m, dtype=float), radius_m))

    def _show(self, light: Callable[[], FloatArray]) -> None:
        self._part.light = light
        self._part.revision += 1

    def _light_between(self, positions_m: FloatArray, radius_m: float) -> FloatArray:
        """The light (R, R), 0 to 1, that candies leave, too."""
        with np.errstate(invalid="ignore"):
            is_low = np.abs(positions_m[:, 2] - self._center_m[2] - radius_m / 2) < _CANDY_BAND_M
        discs = positions_m[is_low, None, :2] + radius_m * _DISC
        spread = self._spread(self._is_covered(discs.reshape(-1, 2)), _CANDY_SPREAD_M)
        light: FloatArray = self._clear * (1 - _CANDY_DARKNESS * spread)
        return light

    def _light_beside(self, casters_m: FloatArray) -> FloatArray:
        """The light (R, R), 0 to 1, that what stands there leaves; points outside the ground do not count."""
        light = np.ones((_N_CELLS, _N_CELLS))
        above_m = casters_m[:, 2] - self._center_m[2]
        bottom_m = -np.inf
        for top_m, spread_m, darkness in _BANDS:
            is_in = (above_m > bottom_m) & (above_m <= top_m)
            covered = self._is_covered(casters_m[is_in, :2])
            light *= 1 - darkness * self._spread(covered, spread_m)
            bottom_m = top_m
        return light

    def _is_covered(self, points_m: FloatArray) -> BoolArray:
        """Which cells (R, R) hold one of the points (N, 2)."""
        share = (points_m - self._center_m[:2]) / self._part.half_m / 2 + 0.5
        cells = (share[((share >= 0) & (share < 1)).all(axis=1)] * _N_CELLS).astype(np.intp)
        covered = np.zeros((_N_CELLS, _N_CELLS), dtype=bool)
        covered[cells[:, 1], cells[:, 0]] = True
        return covered

    def _spread(self, covered: BoolArray, spread_m: float) -> FloatArray:
        """Spread (R, R) over so many metres, much as a bell curve would."""
        spread = covered.astype(float)
        if not covered.any():
            return spread
        for axis in range(2):
            cell_m = 2 * self._part.half_m[1 - axis] / _N_CELLS
            reach = max(int(spread_m / cell_m), 1)
            for _ in range(2):
                spread = _moving_mean(spread, reach, axis)
        return np.minimum(1.6 * spread, 1.0)


def _moving_mean(values: FloatArray, reach: int, axis: int) -> FloatArray:
    """The mean over `reach` values on both sides along an axis, zeros beyond the ends."""
    pad = [(0, 0), (0, 0)]
    pad[axis] = (reach + 1, reach)
    sums = np.cumsum(np.pad(values, pad), axis=axis)
    n = values.shape[axis]
    ends = np.take(sums, np.arange(2 * reach + 1, 2 * reach + 1 + n), axis=axis)
    starts = np.take(sums, np.arange(n), axis=axis)
    mean: FloatArray = (ends - starts) / (2 * reach + 1)
    return mean
