from __future__ import annotations

import numpy as np
import pytest

from app.gui.theme import DARK, LIGHT
from app.gui.views.scene import ColorScale
from app.gui.views.scene.parts import Paint

SCALE = ColorScale("Height", "mm", 10, 20)


def test_a_scale_begins_dark_and_ends_yellow():
    low, high = SCALE.colors([10, 20])
    assert low[:3] == pytest.approx((0.267, 0.005, 0.329), abs=0.005)
    assert high[:3] == pytest.approx((0.993, 0.906, 0.144), abs=0.005)


def test_values_beyond_the_ends_have_the_ends_colours():
    assert (SCALE.colors([-5, 99]) == SCALE.colors([10, 20])).all()


def test_no_value_no_colour():
    assert SCALE.colors([np.nan]).tolist() == [[0, 0, 0, 0]]


def test_a_scale_without_a_span_colours_everything_alike():
    assert len(np.unique(ColorScale("x", "m", 1, 1).colors([0, 1, 2]), axis=0)) == 1


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_paint_follows_the_theme(theme):
    color = Paint(("kept",), opacity=0.5).colors(theme)
    kept = theme.color("kept")
    assert color == pytest.approx((kept.redF(), kept.greenF(), kept.blueF(), 0.5), abs=1e-4)


def test_paint_names_a_colour_for_each_vertex():
    colors = Paint(("kept", "lost"), which=np.array([0, 1, 1], dtype=np.uint8)).colors(LIGHT)
    assert (colors[1] == colors[2]).all()
    assert (colors[0] != colors[1]).any()


def test_paint_without_a_value_falls_back_to_its_name():
    paint = Paint(("body",), values=np.array([15, np.nan], dtype=np.float32), scale=SCALE)
    known, unknown = paint.colors(LIGHT)
    assert known == pytest.approx(SCALE.colors([15])[0])
    assert unknown == pytest.approx(Paint(("body",)).colors(LIGHT))
