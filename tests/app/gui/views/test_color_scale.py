from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from PySide6.QtGui import QColor

from app.gui.views.color_scale import TURBO, VIRIDIS, color_table, text_on, viridis


@pytest.mark.parametrize(("anchors", "name"), [(VIRIDIS, "viridis"), (TURBO, "turbo")])
def test_the_tables_are_the_known_scales(anchors, name):
    known = 255 * matplotlib.colormaps[name](np.linspace(0, 1, 256))[:, :3]
    assert np.abs(color_table(anchors) - known).max() < 9


def test_outside_are_the_ends():
    assert viridis(-1) == viridis(0)
    assert viridis(2) == viridis(1)


def test_text_always_reads():
    def luminance(color):
        return np.dot([0.2126, 0.7152, 0.0722], [linear(c) for c in color.getRgbF()[:3]])

    def linear(c):
        return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4

    for ratio in np.linspace(0, 1, 21):
        back = viridis(ratio)
        light, dark = sorted((luminance(back), luminance(text_on(back))), reverse=True)
        assert (light + 0.05) / (dark + 0.05) >= 4.5  # WCAG AA
    assert text_on(QColor("white")) == QColor("black")
