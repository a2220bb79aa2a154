from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtGui import QImage

from app.gui.theme import theme_of
from app.gui.views.footprint import FootprintView
from core.report.plot_geometry import FootprintPlan


@pytest.fixture
def view(qtbot):
    widget = FootprintView()
    qtbot.addWidget(widget)
    widget.resize(320, 300)
    return widget


def places_of(view, name):
    """The pixels (n, 2) of about a theme's colour, above the legend."""
    image = view.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    pixels = rows[:-30, : 3 * image.width()].reshape(image.height() - 30, image.width(), 3).astype(int)
    wanted = np.array(theme_of(view).color(name).getRgb()[:3])
    return np.argwhere(np.abs(pixels - wanted).sum(axis=2) < 120)[:, ::-1].astype(float)


def show(view, drops, retained, center=(0.2, -0.4)):
    outline = np.array([[0.15, -0.45], [0.25, -0.45], [0.25, -0.35], [0.15, -0.35]])
    plan = FootprintPlan(np.array(drops), np.array(retained), outline)
    if center is not None:
        axes = np.array([[[0.17, -0.4], [0.23, -0.4]], [[0.2, -0.42], [0.2, -0.38]]])
        plan = replace(plan, center_m=np.array(center), axes_m=axes)
    view.set_footprint(plan)


def test_x_goes_right_and_y_goes_up(view):
    show(view, [[0.24, -0.36], [0.16, -0.44]], [True, False], center=None)
    kept, lost = places_of(view, "kept").mean(axis=0), places_of(view, "lost").mean(axis=0)
    assert kept[0] > lost[0] + 50
    assert kept[1] < lost[1] - 50


def test_both_axes_have_the_same_scale(view):
    show(view, [[0.16, -0.44], [0.24, -0.44]], [True, True], center=None)
    across = np.ptp(places_of(view, "kept")[:, 0])
    show(view, [[0.16, -0.44], [0.16, -0.36]], [True, True], center=None)
    up = np.ptp(places_of(view, "kept")[:, 1])
    assert across == pytest.approx(up, abs=2)


def test_numbers_are_told_also_without_seeing(view):
    show(view, [[0.2, -0.4], [0.21, -0.4], [0.22, -0.4]], [True, False, True])
    assert view.accessibleDescription() == "2 of 3 candies stayed"
    view.clear()
    assert view.accessibleDescription() == ""


def test_kept_and_lost_have_different_shapes(view):
    """A disc covers its middle and no corner of its box; a cross covers both."""
    show(view, [[0.2, -0.4]], [True], center=None)
    disc = places_of(view, "kept")
    size = np.ptp(disc, axis=0) + 1
    assert len(disc) > 0.5 * size.prod()
    show(view, [[0.2, -0.4]], [False], center=None)
    cross = places_of(view, "lost")
    assert len(cross) > 5
    assert len(cross) < 0.5 * (np.ptp(cross, axis=0) + 1).prod()


def test_nothing_dropped_and_nothing_kept_can_be_drawn(view):
    assert not view.grab().isNull()
    nothing = FootprintPlan(np.zeros((0, 2)), np.zeros(0, bool), np.zeros((0, 2)))
    view.set_footprint(replace(nothing, outline_m=np.array([[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]])))
    assert not view.grab().isNull()
    view.set_footprint(replace(nothing, pivot_radii_m=(0.01,)))
    assert not view.grab().isNull()
