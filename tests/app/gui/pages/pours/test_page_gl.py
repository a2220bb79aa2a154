"""The Pours page drawn with OpenGL: a click on a pivot selects its pour."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from app.gui.pages.pours.page import PoursPage
from app.gui.views.pour_map import PourMap

pytestmark = pytest.mark.gl


@pytest.fixture
def page(desk, qtbot, mug_session):
    page = PoursPage(desk)
    qtbot.addWidget(page)
    page.resize(1200, 800)
    with qtbot.waitExposed(page):
        page.show()
    desk.workspace.open(mug_session)
    qtbot.waitUntil(lambda: page.content is not None)
    return page


def test_a_click_on_a_pivot_selects_its_pour(page, qtbot):
    scene, grid = page._scene.scene, page.content.grid
    scene.look_from("top")
    page.select(4, 0)
    camera, canvas = scene._navigator.camera, scene._canvas
    pixels = camera.project(grid.pivot_m.reshape(-1, 3), (canvas.width(), canvas.height()))
    picked = []
    for i in (0, 6):
        x, y = pixels[3 * i + 2]
        page._scene.timeline.set_time(0.0)
        qtbot.mouseClick(canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
        picked.append(page.findChild(PourMap).selection)
    assert picked == [(0, 2), (6, 2)]


def test_the_cup_moves_in_the_picture(page, qtbot):
    scene, timeline = page._scene.scene, page._scene.timeline
    timeline.set_time(0.0)
    qtbot.wait(100)
    start = pixels_of(scene.grab_image())
    timeline.set_time(timeline.duration_s)
    qtbot.wait(100)
    end = pixels_of(scene.grab_image())
    assert start.shape == end.shape
    assert (np.abs(start.astype(int) - end).max(axis=2) > 20).mean() > 0.005


def pixels_of(image):
    image = image.convertToFormat(image.Format.Format_RGB888)
    whole = bytes(image.constBits())
    rows = np.frombuffer(whole, np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3)
