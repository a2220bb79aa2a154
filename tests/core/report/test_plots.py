from io import BytesIO

import matplotlib.pyplot as plt
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.report import footprint_plot, pour_map
from core.report.plots import DARK, LIGHT, retention_plot


def pixels(png: bytes) -> NDArray[np.uint8]:
    with Image.open(BytesIO(png)) as image:
        assert image.format == "PNG"
        return np.asarray(image.convert("RGB"))


def has_color(image: NDArray[np.uint8], color: str) -> bool:
    rgb = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
    return bool((np.abs(image.astype(int) - rgb).max(axis=-1) <= 3).sum() > 30)


def assert_nothing_is_cut(image: NDArray[np.uint8], background: str) -> None:
    """The outermost pixels are empty: no text runs over the edge."""
    rgb = [int(background[k : k + 2], 16) for k in (1, 3, 5)]
    edges = (image[:2], image[-2:], image[:, :2], image[:, -2:])
    for edge in edges:
        assert np.abs(edge.astype(int) - rgb).max() <= 3


@pytest.mark.parametrize("dark", [False, True])
def test_footprint_shows_kept_and_lost(tray: Containability, block: Containability, dark: bool) -> None:
    colors = DARK if dark else LIGHT
    image = pixels(footprint_plot(tray, dark=dark))
    assert has_color(image, colors.kept) and has_color(image, colors.lost)
    image = pixels(footprint_plot(block, dark=dark))
    assert has_color(image, colors.lost)
    assert_nothing_is_cut(image, colors.background)


def test_footprint_of_a_single_candy(tray: Containability) -> None:
    from dataclasses import replace

    from core.imagination.results import Footprint

    kept = np.zeros(tray.n_drop, dtype=bool)
    kept[40] = True
    lonely = replace(tray, retained=kept, footprint=Footprint.of(tray.drop_positions_m[kept, :2], 0.08))
    assert len(pixels(footprint_plot(lonely))) > 500


@pytest.mark.parametrize("dark", [False, True])
def test_retention_plot_shows_the_mean_and_the_worst_direction(dark: bool) -> None:
    n_left = np.array([[20, 20, 15, 5]] * 7 + [[20, 10, 0, 0]])
    tilts_rad = np.radians([0.0, 30.0, 60.0, 90.0])
    png = retention_plot(Retention(24, 20, tilts_rad, np.arange(8) * np.pi / 4, n_left), dark=dark)
    image, colors = pixels(png), DARK if dark else LIGHT
    assert has_color(image, colors.kept)
    assert has_color(image, colors.lost)
    assert_nothing_is_cut(image, colors.background)


@pytest.mark.parametrize("dark", [False, True])
def test_pour_map_is_whole(tray: Containability, pours: PourGrid, choice: PourChoice, dark: bool) -> None:
    image = pixels(pour_map(pours, choice, tray, dark=dark))
    assert image.shape[1] >= 800
    assert has_color(image, "#fde725") and has_color(image, "#440154")  # both ends of viridis
    assert_nothing_is_cut(image, (DARK if dark else LIGHT).background)


def test_pour_map_turns_with_the_world(
    tray: Containability, one_direction: PourGrid, choice: PourChoice
) -> None:
    image = pixels(pour_map(one_direction, choice, tray)).astype(int)
    height, width = image.shape[0] * 13 // 16, image.shape[1]
    yellow = np.abs(image[:height] - [253, 231, 37]).max(axis=-1) < 6
    rows, columns = np.nonzero(yellow)
    assert columns.mean() > width / 2 and rows.mean() < height / 2  # 34 degrees: to the right and up


def test_plots_are_repeatable_and_leave_no_global_figure(
    tray: Containability, pours: PourGrid, choice: PourChoice
) -> None:
    assert footprint_plot(tray) == footprint_plot(tray)
    assert pour_map(pours, choice, tray) == pour_map(pours, choice, tray)
    assert plt.get_fignums() == []
