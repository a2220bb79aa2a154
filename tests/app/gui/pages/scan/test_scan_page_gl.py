"""The Scan page drawn: the cell is seen, and a click on a view's pyramid selects it."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from core.geometry import transform_points
from hardware.cell import read_cell

pytestmark = pytest.mark.gl


def test_the_cell_is_drawn_and_a_pyramid_can_be_clicked(qtbot, desk, make_page, mug_session):
    desk.workspace.open(mug_session)
    page = make_page(read_cell())
    scene = page.left.view.scene
    qtbot.wait(300)
    picture = scene.grab_image()
    colors = {
        picture.pixel(x, y) for x in range(0, picture.width(), 7) for y in range(0, picture.height(), 7)
    }
    assert len(colors) > 50
    middle = transform_points(page._views.views[20].T_base_camera, np.array([[0.0, 0.0, 0.03]]))
    x, y = scene._camera.project(middle, (scene.width(), scene.height()))[0]
    qtbot.mouseClick(scene._canvas.widget, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert page.left.grid.selection == 20
