"""In windows of 1280 x 800 and 1920 x 1080 all views of a scan are seen at a glance, and can be picked."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QListView

from app.gui.views.painting import tabular
from app.gui.views.thumbnails import Thumbnail

pytestmark = pytest.mark.usefixtures("themed")


@pytest.fixture
def scan_page(window, qtbot):
    window.show_page("scan")
    qtbot.waitUntil(lambda: window.desk.background.is_idle)
    return window.page("scan")


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080)], ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("n", [24, 30])
def test_all_views_are_seen_and_picked_by_mouse_and_keys(window, scan_page, qtbot, size, n):
    window.resize(*size)
    left = scan_page.left
    left.grid.set_items([Thumbnail(f"frame-{k:06d}", str(k + 1), "taken") for k in range(n)])
    left.fit_thumbnails()
    qtbot.wait(50)
    view = left.grid.findChild(QListView)
    places = [view.visualRect(view.model().index(row, 0)) for row in range(n)]
    assert all(view.viewport().rect().contains(place) for place in places)
    assert view.verticalScrollBar().maximum() == 0
    digits = QFontMetrics(tabular(view.font(), 8.0)).horizontalAdvance("30")
    assert places[0].width() > 2 * digits
    assert left.view.height() > size[1] / 2.5  # the 3D view stays the largest
    with qtbot.waitSignal(left.view_picked) as heard:
        qtbot.mouseClick(view.viewport(), Qt.MouseButton.LeftButton, pos=places[23].center())
    assert heard.args == [23]
    with qtbot.waitSignal(left.view_picked) as heard:
        qtbot.keyClick(view, Qt.Key.Key_Left)
    assert heard.args == [22]
