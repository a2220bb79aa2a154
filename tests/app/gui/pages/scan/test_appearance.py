"""The overlay of looks on the Scan page's colour image."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QCheckBox, QLabel

from app.gui.pages.scan.appearance import AppearanceRow, ShownLook, load_look
from app.gui.pages.scan.loading import Picture
from core.appearance.network import WEIGHTS_FILE
from core.scan.view_files import read_color


@pytest.fixture
def shown(qtbot, desk, make_page, few_views, mug_session):
    """The page on a scanned mug, with its overlay's switch and words."""
    page = make_page(few_views)
    desk.workspace.open(mug_session)
    qtbot.waitUntil(lambda: page.content is not None and page.content.source == "scan")
    qtbot.waitUntil(lambda: desk.background.is_idle)
    return page, page.findChild(QCheckBox, "appearance"), page.findChild(QLabel, "appearance_said")


def test_the_overlay_is_off_until_somebody_wants_it(shown):
    _, switch, said = shown
    assert not switch.isChecked() and not said.isVisible()


def test_it_says_how_good_the_shipped_network_is(shown):
    _, switch, _ = shown
    with (WEIGHTS_FILE.parent / "curves.csv").open(newline="") as file:
        last = list(csv.DictReader(file))[-1]
    assert f"judges {100 * float(last['held_out_accuracy']):.0f} % rightly" in switch.toolTip()


def test_it_shows_what_contains_and_the_score_and_goes_away_again(qtbot, desk, shown):
    page, switch, said = shown
    plain = page.side._image._image.copy()
    switch.click()
    qtbot.waitUntil(lambda: said.text().startswith("Score "))
    qtbot.waitUntil(lambda: desk.background.is_idle)
    assert page.side._image._image != plain
    assert "looks like" in said.text()
    switch.click()
    assert not said.text()
    assert page.side._image._image == plain


def test_another_view_is_looked_at_anew(qtbot, desk, shown):
    page, switch, said = shown
    switch.click()
    qtbot.waitUntil(lambda: said.text().startswith("Score "))
    first = page.side._image._image.copy()
    page._select(3)
    qtbot.waitUntil(lambda: desk.background.is_idle and said.text().startswith("Score "))
    assert page.side._image._image != first


def test_a_view_is_looked_at_as_it_lies_on_the_disk(mug_session):
    folder = mug_session / "scan" / "rgbd"
    pictures = [Picture(path, 0) for path in sorted(folder.glob("*.color.png"))]
    looks = [load_look(picture) for picture in pictures]
    assert all(look is not None and 0 <= look.score <= 1 for look in looks)
    color = read_color(pictures[0].color)
    assert looks[0].color.shape == color.shape
    changed = (looks[0].color != color).any(axis=2)
    assert 0.001 < changed.mean() < 0.3


def test_a_scan_that_is_not_finished_is_not_looked_at(tmp_path):
    assert load_look(Picture(tmp_path / "rgbd" / "frame-000000.color.png", 0)) is None


def test_it_says_where_looks_and_physics_disagree(qtbot):
    row = AppearanceRow()
    qtbot.addWidget(row)
    said = row.findChild(QLabel, "appearance_said")
    look = ShownLook(np.zeros((2, 2, 3), dtype=np.uint8), 0.93, 0.31, False)
    row.describe(look)
    assert said.text() == (
        "Score 0.93: looks like an open container. 31 % of the frame contains. By physics it is none."
    )
    row.describe(replace(look, is_container_by_physics=True))
    assert said.text().endswith("Physics agrees.")
    row.describe(replace(look, score=0.1, is_container_by_physics=True))
    assert said.text().endswith("By physics it is an open container.")
    row.describe(replace(look, is_container_by_physics=None))
    assert said.text().endswith("contains.")
    row.describe(None)
    assert "does not show the object" in said.text()
