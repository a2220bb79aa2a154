from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from app.gui.views.pour_map import MappedPour, PourMap


def cells(n_directions=8):
    return [
        MappedPour(i, j, i * pi / 4, 0.01 + 0.02 * j, p=(i + j) / 10, spread=0.03, is_feasible=(i != 3))
        for i in range(n_directions)
        for j in range(3)
    ]


@pytest.fixture
def pour_map(qtbot):
    widget = PourMap()
    qtbot.addWidget(widget)
    widget.resize(360, 448)
    widget.set_pours(cells(), chosen=(2, 1))
    widget.show()
    return widget


def luminance(color):
    channels = np.array(color.getRgbF()[:3])
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def place(widget, i, j):
    return widget.cell_center(i, j).toPoint()


def test_a_click_picks_the_pour_under_it(qtbot, pour_map):
    for key in ((0, 0), (3, 2), (7, 1)):
        with qtbot.waitSignal(pour_map.selected) as heard:
            qtbot.mouseClick(pour_map, Qt.MouseButton.LeftButton, pos=place(pour_map, *key))
        assert tuple(heard.args) == key == pour_map.selection


def test_direction_zero_is_right_and_ninety_degrees_up(pour_map):
    middle = pour_map._center().toPoint()
    assert place(pour_map, 0, 1).x() > middle.x() + 50
    assert abs(place(pour_map, 0, 1).y() - middle.y()) <= 1
    assert place(pour_map, 2, 1).y() < middle.y() - 50


@pytest.mark.parametrize("points", [8, 11, 18])
def test_whatever_the_font_no_line_of_the_legend_is_cut(qtbot, pour_map, points):
    font = pour_map.font()
    font.setPointSize(points)
    pour_map.setFont(font)
    pour_map.set_pours([replace(cell, clean_at_least=0.5) for cell in cells()], chosen=(2, 1))
    pour_map.resize(pour_map.minimumSizeHint())
    picture = pour_map.grab().toImage()
    lowest = {picture.pixel(x, picture.height() - 1) for x in range(picture.width())}
    assert len(lowest) == 1, "nothing is drawn there"


def test_turning_moves_the_cells_anticlockwise(qtbot, pour_map):
    before = place(pour_map, 2, 1)
    pour_map.set_rotation(90)
    assert (place(pour_map, 0, 1) - before).manhattanLength() <= 2
    with qtbot.waitSignal(pour_map.selected) as heard:
        qtbot.mouseClick(pour_map, Qt.MouseButton.LeftButton, pos=before)
    assert heard.args == [0, 1]


def test_arrow_keys_go_around_and_out_and_end_at_the_rim(qtbot, pour_map):
    assert pour_map.selection == (2, 1)  # the chosen one at first
    qtbot.keyClick(pour_map, Qt.Key.Key_Right)
    assert pour_map.selection == (1, 1)
    for _ in range(3):
        qtbot.keyClick(pour_map, Qt.Key.Key_Up)
    assert pour_map.selection == (1, 2)
    for _ in range(2):
        qtbot.keyClick(pour_map, Qt.Key.Key_Right)
    assert pour_map.selection == (7, 2)


def test_selecting_from_outside_sends_nothing(qtbot, pour_map):
    with qtbot.assertNotEmitted(pour_map.selected):
        pour_map.select(5, 0)
    assert pour_map.selection == (5, 0)


def test_the_tooltip_tells_all_facts(pour_map):
    said = pour_map.describe(3, 2)
    for word in ("135°", "50.0 mm", "50 ± 3 %", "cannot"):
        assert word in said
    assert "chosen" in pour_map.describe(2, 1)
    assert "the arm can make it" in pour_map.describe(2, 1)


def test_a_comparison_says_by_how_much(pour_map):
    pour_map.set_comparison(np.full((8, 3), 0.2), "theta fixed")
    assert "+30 points against theta fixed (20 %)" in pour_map.describe(3, 2)
    assert "\u221210 points" in pour_map.describe(0, 1)


def test_a_comparison_of_another_shape_is_refused_and_one_outlived_is_dropped(pour_map):
    with pytest.raises(ValueError, match=r"\(1, 3\)"):
        pour_map.set_comparison(np.zeros((1, 3)), "theta fixed")
    pour_map.set_comparison(np.zeros((8, 3)), "before")
    pour_map.set_pours(cells(1), chosen=(0, 0))
    assert "before" not in pour_map.describe(0, 0)


@pytest.mark.parametrize(("moved_to", "then"), [(None, (0, 1)), ((0, 2), (0, 2)), ((5, 0), (0, 1))])
def test_the_selection_follows_the_chosen_pour_unless_somebody_moved_it(pour_map, moved_to, then):
    if moved_to is not None:
        pour_map.select(*moved_to)
    pour_map.set_pours(cells(1), chosen=(0, 1))
    assert pour_map.selection == then


def test_a_single_direction_lies_where_it_points(qtbot, pour_map):
    pour_map.set_pours([MappedPour(0, j, pi / 2, 0.01 * j, 0.5) for j in range(3)], chosen=None)
    assert pour_map.selection is None
    assert place(pour_map, 0, 2).y() < 100
    with qtbot.assertNotEmitted(pour_map.selected):
        qtbot.mouseClick(pour_map, Qt.MouseButton.LeftButton, pos=QPoint(180, 300))
    assert not pour_map.grab().isNull()


def test_the_number_is_readable_at_360_px(pour_map):
    """Text and background of the darkest and the lightest cell stand well apart."""
    pour_map.set_pours([MappedPour(0, j, 0.0, 0.01 * j, p) for j, p in enumerate((0.0, 0.5, 1.0))], None)
    image = pour_map.grab().toImage()
    for j in range(3):
        at = place(pour_map, 0, j)
        luminances = [
            luminance(image.pixelColor(at.x() + dx, at.y() + dy))
            for dx in range(-12, 13)
            for dy in range(-6, 7)
        ]
        assert (max(luminances) + 0.05) / (min(luminances) + 0.05) > 4.5  # WCAG AA


def tried(p=1.0, clean=(0.3, 0.8)):
    return [
        MappedPour(i, j, i * pi / 4, 0.01 + 0.02 * j, p, clean_at_least=clean[i % 2], n_tries=13)
        for i in range(8)
        for j in range(3)
    ]


def color_of(widget, i, j):
    at = widget.cell_center(i, j)
    return widget.grab().toImage().pixelColor(at.toPoint() + QPoint(0, -15)).name()


def test_where_tries_are_known_colours_tell_how_sure_a_clean_pour_is(pour_map):
    pour_map.set_pours(tried(), chosen=None)
    assert pour_map.shows_clean
    assert color_of(pour_map, 0, 2) != color_of(pour_map, 1, 2)
    assert "clean pour: at least 80 % likely, after 13 tries" in pour_map.describe(1, 0)
    pour_map.show_clean(False)
    assert not pour_map.shows_clean
    assert color_of(pour_map, 0, 2) == color_of(pour_map, 1, 2)


def test_without_tries_and_in_a_comparison_colours_tell_p(pour_map):
    assert not pour_map.has_clean and not pour_map.shows_clean
    pour_map.set_pours(tried(), chosen=None)
    pour_map.set_comparison(np.full((8, 3), 0.2), "theta fixed")
    assert not pour_map.shows_clean
    pour_map.set_comparison(None)
    assert pour_map.shows_clean


def n_inked(widget, i, j):
    """How many pixels about the middle of a cell have its number's colour, far from the cell's own."""
    image, at = widget.grab().toImage(), place(widget, i, j)
    around = [image.pixelColor(at.x() + x, at.y() + y) for x in range(-6, 7) for y in range(-4, 5)]
    return sum(abs(luminance(one) - luminance(around[0])) > 0.4 for one in around)


def test_where_a_number_would_reach_into_its_neighbours_the_colour_alone_tells(pour_map):
    pour_map.set_pours([MappedPour(i, j, i * pi / 4, 0.01, p=1.0) for i in range(8) for j in range(3)], None)
    pour_map.resize(420, 480)
    assert n_inked(pour_map, 2, 1) > 5
    pour_map.resize(200, 280)
    assert n_inked(pour_map, 2, 1) == 0
