from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtWidgets import QListView

from app.gui.views.thumbnails import Thumbnail, ThumbnailGrid

LEFT = Qt.MouseButton.LeftButton


def picture(folder, name, color):
    image = QImage(640, 480, QImage.Format.Format_RGB32)
    image.fill(QColor(color))
    path = folder / name
    assert image.save(str(path))
    return path


def items(n=24, state="pending"):
    return [Thumbnail(f"view-{k}", str(k + 1), state) for k in range(n)]


@pytest.fixture
def grid(qtbot):
    widget = ThumbnailGrid()
    qtbot.addWidget(widget)
    widget.resize(380, 260)
    widget.show()
    return widget


def view_of(grid):
    return grid.findChild(QListView)


def rect_of(grid, row):
    view = view_of(grid)
    return view.visualRect(view.model().index(row, 0))


def color_at(grid, row):
    at = rect_of(grid, row).center()
    return view_of(grid).viewport().grab().toImage().pixelColor(at.x() + 8, at.y()).getRgb()[:3]


def test_24_views_fit_into_380_by_260(qtbot, grid):
    grid.set_items(items())
    qtbot.wait(20)
    last = rect_of(grid, 23)
    assert view_of(grid).viewport().rect().contains(last)
    assert last.width() >= 58


@pytest.mark.parametrize("size", [(200, 150), (300, 400), (900, 300)])
def test_cells_wrap_to_the_width(qtbot, grid, size):
    grid.set_items(items())
    grid.resize(*size)
    qtbot.wait(20)
    viewport = view_of(grid).viewport().rect()
    assert all(rect_of(grid, row).right() <= viewport.right() for row in range(24))
    assert rect_of(grid, 23).top() > rect_of(grid, 0).top()


def test_pictures_arrive_from_files_and_from_memory(qtbot, grid, tmp_path):
    memory = QImage(64, 48, QImage.Format.Format_RGB32)
    memory.fill(QColor("#102030"))
    path = picture(tmp_path, "one.png", "#c86432")
    grid.set_items([Thumbnail("a", "1", "taken", path), Thumbnail("b", "2", "taken", memory)])
    qtbot.waitUntil(lambda: color_at(grid, 0) == (0xC8, 0x64, 0x32))
    qtbot.waitUntil(lambda: color_at(grid, 1) == (0x10, 0x20, 0x30))


def test_a_retaken_view_shows_its_new_picture(qtbot, grid, tmp_path):
    grid.set_items([Thumbnail("a", "1", "poor", picture(tmp_path, "one.png", "#c86432"))])
    qtbot.waitUntil(lambda: color_at(grid, 0) == (0xC8, 0x64, 0x32))
    grid.set_item(0, Thumbnail("a", "1", "taken", picture(tmp_path, "one.png", "#203040")))
    qtbot.waitUntil(lambda: color_at(grid, 0) == (0x20, 0x30, 0x40))


def test_a_file_that_cannot_be_read_leaves_an_empty_box(qtbot, grid, tmp_path):
    (tmp_path / "bad.png").write_bytes(b"no picture")
    grid.set_items([Thumbnail("a", "1", "failed", tmp_path / "bad.png")])
    qtbot.wait(200)
    assert not grid.grab().isNull()


def test_a_click_selects_one(qtbot, grid):
    grid.set_items(items())
    qtbot.wait(20)
    with qtbot.waitSignal(grid.selected) as heard:
        qtbot.mouseClick(view_of(grid).viewport(), LEFT, pos=rect_of(grid, 7).center())
    assert heard.args == [7]
    qtbot.mouseClick(view_of(grid).viewport(), LEFT, pos=rect_of(grid, 9).center())
    assert grid.selection == 9


def test_selecting_from_outside_sends_nothing_and_survives_new_items(qtbot, grid):
    grid.set_items(items())
    with qtbot.assertNotEmitted(grid.selected):
        grid.select(5)
        grid.set_items(list(reversed(items())))
    assert grid.items[grid.selection].name == "view-5"
    grid.select(None)
    assert grid.selection is None


def test_the_state_is_shown_in_a_word(grid):
    grid.set_items(items(1))
    model = view_of(grid).model()
    role = Qt.ItemDataRole.AccessibleTextRole
    assert model.data(model.index(0, 0), role) == "1, pending"
    grid.set_item(0, Thumbnail("view-0", "1", "poor", tooltip="blurred"))
    assert model.data(model.index(0, 0), role) == "1, poor"
    assert model.data(model.index(0, 0), Qt.ItemDataRole.ToolTipRole) == "blurred"


def test_closing_while_pictures_load_is_quiet(qtbot, tmp_path):
    path = picture(tmp_path, "one.png", "#c86432")
    for _ in range(5):
        grid = ThumbnailGrid()
        grid.set_items([Thumbnail(str(k), str(k), "taken", path) for k in range(24)])
        grid.deleteLater()
        del grid
    qtbot.wait(300)
