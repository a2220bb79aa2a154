"""In a window of 1280 x 800 all that is said of a drop is seen without scrolling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QRect
from PySide6.QtWidgets import QLabel, QPushButton, QScrollArea

from core.imagination.verdict import Verdict
from core.parameters import apply_settings

pytestmark = pytest.mark.usefixtures("themed")

SIEVE = Verdict(
    0.034, 0.1, 1310.0, 1463.0, level_candies=740.0, level_ml=805.0, too_small_m=0.0066
)  # the longest verdict there is: level and heaped, what falls through it, and no container
UNDECIDED = Verdict(0.034, 0.1, 1310.0, 1463.0, unseen_ml=1240.0, other_share=0.4)
LEGIBLE_PX = 180
"""Of the footprint's height."""


@pytest.fixture
def page(window, mug_session, qtbot):
    window.resize(1280, 800)
    window.desk.open_session(mug_session)
    window.show_page("imagination")
    page = window.page("imagination")
    qtbot.waitUntil(lambda: page.content is not None and window.desk.background.is_idle)
    return page


def show(page, verdict):
    """Show a drop of which as much is said as can be."""
    drop = page.drop
    n_steps = len(drop.retention.tilt_rad)
    n_left = np.linspace(drop.retention.n_load, 0, n_steps).astype(int)  # some fall early, half of them later
    page.side.show_drop(
        replace(
            drop,
            containability=replace(drop.containability, verdict=verdict),
            retention=replace(drop.retention, n_left=np.tile(n_left, (8, 1))),
            capacity=replace(
                drop.capacity, volume_ml=9000.0, is_hollow_told=False, least_ml=8888.0, most_ml=9999.0
            ),
            phases=tuple(replace(phase, n_inside=290) for phase in drop.phases),
            n_on_top=12,
        )
    )


def scrolled_px(page):
    return page.side.findChild(QScrollArea).verticalScrollBar().maximum()


def unseen(page):
    """Texts of the panel that are not whole in the part of it that is seen."""
    area = page.side.findChild(QScrollArea)
    seen = area.viewport().rect()
    labels = [label for label in area.widget().findChildren(QLabel) if label.isVisible() and label.text()]
    return [
        label.text()
        for label in labels
        if not seen.contains(QRect(label.mapTo(area.viewport(), label.rect().topLeft()), label.size()))
        or label.heightForWidth(label.width()) > label.height()
    ]


@pytest.mark.parametrize("verdict", [SIEVE, UNDECIDED, None], ids=["sieve", "undecided", "omega"])
@pytest.mark.parametrize("part", ["footprint", "retention"])
def test_the_longest_verdict_and_all_facts_are_seen_without_scrolling(page, qtbot, verdict, part):
    page.findChild(QPushButton, f"side_page_{part}").click()
    show(page, verdict)
    qtbot.wait(50)
    assert scrolled_px(page) == 0
    assert unseen(page) == []
    titles = [fact.title for fact in page.side.facts.facts]
    assert titles == ["Holds", "Tilted", "Dropped", "Inside after", "Seed", "Took"]
    assert getattr(page.side, part).height() >= LEGIBLE_PX


def test_nothing_the_verdict_says_is_left_out(page, qtbot):
    show(page, SIEVE)
    said = " ".join(page.findChild(QLabel, f"drop_{name}").text() for name in ("verdict", "details"))
    assert said.replace("\u00a0", " ") == (
        "Not an open container: level with its rim it holds 740 candies (805 ml), heaped 1310. "
        "Candies of 7 mm would fall through its openings. Hollow for 3 % of its bulk (containers: over 10 %)."
    )
    assert page.findChild(QLabel, "drop_reason").text().endswith("12 lie on top, with no wall around them.")
    assert f"Omega {page.drop.containability.omega:.2f}" in page.side.omega.omega_text()


def test_a_note_that_it_is_stale_fits_too(page, window, qtbot):
    show(page, SIEVE)
    workspace = window.desk.workspace
    workspace.edit(apply_settings(workspace.parameters, {"containability.drop_s": 1.0}), "change")
    qtbot.wait(50)
    assert page.side.stale.isVisible()
    assert scrolled_px(page) == 0
    assert unseen(page) == []


def test_the_parameters_take_the_place_of_footprint_and_facts(page, qtbot):
    show(page, SIEVE)
    page.findChild(QPushButton, "side_page_parameters").click()
    qtbot.wait(50)
    assert page.side.parameters.isVisible()
    assert not page.side.footprint.isVisible()
    assert not page.side.facts.isVisible()
    assert scrolled_px(page) == 0  # the editor scrolls by itself
    page.findChild(QPushButton, "side_page_footprint").click()
    assert page.side.facts.isVisible()
    assert not page.side.parameters.isVisible()
