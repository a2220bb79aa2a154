from __future__ import annotations

import time

import numpy as np
import pytest
from PySide6.QtCore import QPointF

from app.gui.views.depth_image import DepthPanel, ImagePanel, depth_colors, range_of, thinned
from tests.awake import in_time


@pytest.fixture
def panel(qtbot):
    widget = DepthPanel()
    qtbot.addWidget(widget)
    widget.resize(380, 260)
    return widget


def ramp():
    depth = np.tile(np.linspace(0.4, 1.2, 640, dtype=np.float32), (480, 1))
    depth[:, :64] = 0
    depth[:10] = np.nan
    return depth


def test_near_is_blue_far_is_red_and_nothing_is_see_through():
    rgba = depth_colors(np.array([[0.4, 1.2, 0.0, np.nan, np.inf, 9.0]], np.float32), 0.4, 1.2)[0]
    near, far, zero, nan, infinite, beyond = rgba.astype(int)
    assert near[2] > near[0]
    assert far[0] > far[2]
    assert (beyond == far).all()
    assert zero[3] == nan[3] == infinite[3] == 0
    assert near[3] == far[3] == 255


def test_the_range_is_round_and_holds_nearly_all():
    low, high = range_of(ramp())
    assert low == pytest.approx(0.45)  # the tenth that is nearest has no depth
    assert high == pytest.approx(1.2)
    assert range_of(np.zeros((10, 10), np.float32)) is None


def test_a_flat_wall_has_a_range_too():
    low, high = range_of(np.full((20, 20), 0.7, np.float32))
    assert low <= 0.7 <= high
    assert high > low


def test_the_tooltip_shows_the_depth_under_the_mouse(panel):
    panel.set_depth(ramp())
    place = panel._place(640, 480)  # where the image lies is no part of the interface
    at = QPointF(place.left() + 0.75 * place.width(), place.center().y())
    assert panel.depth_at(at) == pytest.approx(0.4 + 0.8 * 0.75, abs=0.01)
    assert panel.describe(at).endswith(" m")
    assert panel.describe(QPointF(place.left() + 3, place.center().y())) == "no depth here"
    assert panel.depth_at(QPointF(379, 5)) is None


def test_an_image_without_depth_keeps_the_last_range(panel):
    panel.set_depth(ramp())
    seen = panel.range_m
    panel.set_depth(np.zeros((480, 640), np.float32))
    assert panel.range_m == seen


def test_thinning_keeps_proportions_and_never_goes_below_the_widget():
    assert thinned(np.zeros((480, 640)), 320, 240).shape == (240, 320)
    assert thinned(np.zeros((480, 640)), 400, 400).shape == (480, 640)
    assert thinned(np.zeros((10, 10)), 400, 400).shape == (10, 10)


def test_converting_is_quick(panel):
    depth = ramp()
    times = []
    for _ in range(5):
        begin = time.process_time()
        panel.set_depth(depth)
        times.append(time.process_time() - begin)
    in_time(min(times), 0.010)


def test_colours_are_shown_as_they_are(qtbot):
    panel = ImagePanel()
    qtbot.addWidget(panel)
    panel.resize(320, 240)
    rgb = np.zeros((480, 640, 3), np.uint8)
    rgb[:, :320] = (200, 100, 50)
    panel.set_image(rgb)
    image = panel.grab().toImage()
    assert image.pixelColor(80, 120).getRgb()[:3] == (200, 100, 50)
    assert image.pixelColor(240, 120).getRgb()[:3] == (0, 0, 0)


def test_a_panel_outlives_the_array_it_was_given(qtbot):
    panel = ImagePanel()
    qtbot.addWidget(panel)
    panel.resize(64, 48)
    rgb = np.full((48, 64, 3), 200, np.uint8)
    panel.set_image(rgb)
    rgb[:] = 0
    assert panel.grab().toImage().pixelColor(32, 24).red() == 200


def test_colour_above_depth_covers_the_same_place(qtbot, panel):
    image = ImagePanel(is_above_depth=True)
    qtbot.addWidget(image)
    image.resize(380, 260)
    assert image._place(640, 480) == panel._place(640, 480)


def test_without_an_image_it_says_so(panel):
    panel.set_depth(ramp())
    with_image = panel.grab().toImage()
    panel.set_depth(None)
    assert panel.grab().toImage() != with_image
    assert panel.depth_at(QPointF(100, 100)) is None
