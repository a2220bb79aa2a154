"""The retention curve in the window."""

from __future__ import annotations

import numpy as np
import pytest

from app.gui.theme import theme_of
from app.gui.views.retention_chart import RetentionChart
from core.imagination.retention.result import Retention

TILTS_RAD = np.radians([0.0, 30.0, 60.0, 90.0])


def retention(n_load: int, n_left: list[int]) -> Retention:
    return Retention(24, n_load, TILTS_RAD, np.arange(8) * np.pi / 4, np.tile(n_left, (8, 1)))


@pytest.fixture
def chart(qtbot):
    widget = RetentionChart()
    qtbot.addWidget(widget)
    widget.resize(330, 200)
    return widget


def rows_of_curve(chart) -> list[int]:
    """In which rows the mean curve is drawn in the middle of the chart."""
    image, kept = chart.grab().toImage(), theme_of(chart).color("kept")
    ratio = chart.devicePixelRatioF()
    x = round(0.55 * image.width())
    return [round(y / ratio) for y in range(image.height()) if image.pixelColor(x, y) == kept]


def test_the_curve_is_high_where_candies_stay_and_low_where_they_left(chart):
    chart.show_retention(retention(20, [20, 20, 20, 20]))
    high = rows_of_curve(chart)
    chart.show_retention(retention(20, [20, 0, 0, 0]))
    low = rows_of_curve(chart)
    assert max(high) < chart.height() / 4
    assert min(low) > chart.height() / 2


@pytest.mark.parametrize("nothing", [None, retention(0, [0, 0, 0, 0])])
def test_where_nothing_was_loaded_there_is_no_curve(chart, nothing):
    chart.show_retention(retention(20, [20, 20, 10, 0]))
    assert rows_of_curve(chart)
    assert "20 candies" in chart.toolTip()
    chart.show_retention(nothing)
    assert rows_of_curve(chart) == []
    assert chart.toolTip() == ""
