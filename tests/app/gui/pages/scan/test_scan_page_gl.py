"""The Scan page drawn: the cell is seen, and clicks on the views' pyramids select them."""

from __future__ import annotations

from itertools import product

import pytest
from PySide6.QtCore import QPoint, Qt

from hardware.cell import read_cell

pytestmark = pytest.mark.gl

STEP_PX = 11


def test_the_cell_is_drawn_and_its_pyramids_can_be_clicked(qtbot, desk, make_page, mug_session):
    desk.workspace.open(mug_session)
    page = make_page(read_cell())
    scene = page.left.view.scene
    qtbot.wait(300)
    picture = scene.grab_image()
    places = list(product(range(0, scene.width(), STEP_PX), range(0, scene.height(), STEP_PX)))
    ratio = picture.width() / scene.width()
    assert len({picture.pixel(int(ratio * x), int(ratio * y)) for x, y in places}) > 50
    picked = []
    scene.picked.connect(lambda layer, index: picked.append((layer, index)))
    surface = scene.childAt(scene.rect().center())
    for x, y in places:
        qtbot.mouseClick(surface, Qt.MouseButton.LeftButton, pos=QPoint(x, y))
        if picked and picked[-1][0] == "views":
            assert page.left.grid.selection == picked[-1][1]
        if len({index for layer, index in picked if layer == "views"}) == 5:
            break
    else:
        pytest.fail(f"hardly any pyramid could be clicked: {picked}")
