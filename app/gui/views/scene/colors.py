"""Colours as numbers: quantities by a colour map, and the theme's names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.color_scale import TURBO, VIRIDIS, color_table

if TYPE_CHECKING:
    from app.gui.theme import Theme

ColorArray = npt.NDArray[np.float32]

_MAPS = {"viridis": VIRIDIS, "turbo": TURBO}
_STEPS = 256


@dataclass(frozen=True)
class ColorScale:
    """Which colour stands for which value.

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


def hex_color(color: str) -> ColorArray:
    """Colour (4,) of `#rrggbb`, opaque."""
    return np.array([*(int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)), 1], dtype=np.float32)


def theme_color(theme: Theme, name: str) -> ColorArray:
    """Colour (4,) of a theme's field, opaque."""
    return hex_color(getattr(theme, name))


@lru_cache
def _table(colormap: str) -> ColorArray:
    """The map's colours (257, 4); the last one, transparent, is for what has no value."""
    opaque = np.column_stack([color_table(_MAPS[colormap], _STEPS) / 255, np.ones(_STEPS)])
    return np.vstack([opaque, np.zeros(4)]).astype(np.float32)
