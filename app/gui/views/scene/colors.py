"""Colours as numbers: quantities by a colour map, and the theme's names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from app.gui.theme import Theme

ColorArray = npt.NDArray[np.float32]

_MAPS = {
    "viridis": "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d "
    "2f6b8e 2c728e 297a8e 26828e 23898e 21918c 1f988b 1fa088 22a785 28ae80 32b67a "
    "3fbc73 4ec36b 5ec962 70cf57 84d44b 98d83e addc30 c2df23 d8e219 ece51b fde725",
    "turbo": "30123b 392a73 4040a2 4456c7 466be3 4680f6 4294ff 37a8fa 28bceb 1ccdd8 18ddc2 "
    "1fe9af 32f298 4ef97d 6dfe62 8bff4b a4fc3c b9f635 cdec34 dfdf37 eecf3a f8be39 "
    "fdac34 fe962b fb7e21 f46617 eb500e df3f08 d02f05 be2102 a91601 920b01 7a0403",
}
"""Every eighth of the 256 colours of viridis (CC0) and of turbo (Apache 2.0); between them 1 % is lost."""

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
        return _table(self.colormap)[step]


def hex_color(color: str) -> ColorArray:
    """Colour (4,) of `#rrggbb`, opaque."""
    return np.array([*(int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)), 1], dtype=np.float32)


def theme_color(theme: Theme, name: str) -> ColorArray:
    """Colour (4,) of a theme's field, opaque."""
    return hex_color(getattr(theme, name))


@lru_cache
def _table(colormap: str) -> ColorArray:
    """The map's colours (257, 4); the last one, transparent, is for what has no value."""
    anchors = np.array([hex_color("#" + word) for word in _MAPS[colormap].split()])
    at = np.linspace(0, len(anchors) - 1, _STEPS)
    columns = [np.interp(at, np.arange(len(anchors)), column) for column in anchors.T]
    return np.vstack([np.column_stack(columns), np.zeros(4)]).astype(np.float32)
