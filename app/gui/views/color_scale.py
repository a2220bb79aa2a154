"""Colours for quantities: viridis and turbo, as single colours and as tables for images."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QColor

VIRIDIS = (
    "440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26828e 21918c 1fa088 28ae80 3fbc73 5ec962 84d44b addc30"
    " d8e219 fde725"
)
TURBO = (
    "30123b 4040a2 466be3 4294ff 28bceb 18ddc2 32f298 6dfe62 a4fc3c cdec34 eecf3a fdac34 fb7e21 eb500e d02f05"
    " a91601 7a0403"
)


def color_table(anchors: str, n: int = 256) -> NDArray[np.uint8]:
    """Return (n, 3) colours between the evenly spaced `rrggbb` of a scale."""
    nodes = np.array([[int(word[k : k + 2], 16) for k in (0, 2, 4)] for word in anchors.split()], float)
    at = np.linspace(0, len(nodes) - 1, n)
    channels = [np.interp(at, np.arange(len(nodes)), nodes[:, k]) for k in range(3)]
    return np.stack(channels, axis=1).round().astype(np.uint8)


_VIRIDIS_TABLE = color_table(VIRIDIS)


def viridis(ratio: float) -> QColor:
    """Return viridis at `ratio` in 0..1; what lies outside gets the end's colour."""
    r, g, b = _VIRIDIS_TABLE[round(255 * min(max(ratio, 0.0), 1.0))]
    return QColor(int(r), int(g), int(b))


def text_on(background: QColor) -> QColor:
    """Return black or white, whichever reads better (WCAG contrast) on `background`."""
    linear = [
        channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4
        for channel in (background.redF(), background.greenF(), background.blueF())
    ]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return QColor("black") if luminance > 0.179 else QColor("white")
