from __future__ import annotations

import pytest

from app.gui.theme import theme_of
from app.gui.views.omega_bar import OmegaBar


@pytest.fixture
def bar(qtbot):
    widget = OmegaBar()
    qtbot.addWidget(widget)
    widget.resize(300, widget.sizeHint().height())
    return widget


def filled_share(bar):
    image = bar.grab().toImage()
    accent = theme_of(bar).color("accent")
    row = max(range(image.height()), key=lambda y: count(image, y, accent))
    return count(image, row, accent) / image.width()


def count(image, y, color):
    return sum(image.pixelColor(x, y) == color for x in range(image.width()))


def test_both_numbers_are_written(bar):
    bar.set_values(0.5065, 0.03)
    assert bar.omega_text() == "Omega 0.51"
    assert bar.threshold_text() == "threshold 0.03"


@pytest.mark.parametrize(
    ("omega", "threshold", "texts"),
    [
        (0.0312, 0.03, ("Omega 0.031", "threshold 0.030")),
        (0.0004, 0.0, ("Omega 0.0004", "threshold 0.0000")),
        (0.999, 0.5, ("Omega 0.999", "threshold 0.500")),
        (0.0, 0.0, ("Omega 0.00", "threshold 0.00")),
        (None, 0.03, ("Omega --", "threshold 0.03")),
    ],
)
def test_digits_never_hide_a_difference_that_decides(bar, omega, threshold, texts):
    bar.set_values(omega, threshold)
    assert (bar.omega_text(), bar.threshold_text()) == texts


def test_the_bar_is_as_long_as_omega(bar):
    bar.set_values(0.75, 0.03)
    assert filled_share(bar) == pytest.approx(0.75, abs=0.08)
    bar.set_values(0.25, 0.9)
    assert filled_share(bar) == pytest.approx(0.25, abs=0.08)


def test_the_tooltip_decides_as_the_core_does(bar):
    bar.set_values(0.03, 0.03)
    assert "not above the threshold" in bar.toolTip()
    bar.set_values(0.031, 0.03)
    assert "above the threshold" in bar.toolTip()
    assert "not above" not in bar.toolTip()
    assert "container" not in bar.toolTip(), "Omega need not be what decides"
