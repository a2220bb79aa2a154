from __future__ import annotations

from itertools import pairwise

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFontMetrics, QImage
from PySide6.QtWidgets import QLabel, QListView, QPushButton

from app.gui.views.film_strip import FilmStrip
from app.gui.views.painting import smaller
from app.gui.views.picture_dialog import Picture, PictureDialog

LEFT = Qt.MouseButton.LeftButton
CAPTIONS = [f"pour {k}" for k in range(6)]


@pytest.fixture
def pictures(tmp_path):
    found = []
    for k, caption in enumerate(CAPTIONS):
        image = QImage(320, 240, QImage.Format.Format_RGB32)
        image.fill(QColor(40 * k, 100, 50))
        path = tmp_path / f"{caption}.png"
        assert image.save(str(path))
        found.append(Picture(caption, path))
    return found


@pytest.fixture
def strip(qtbot):
    widget = FilmStrip()
    qtbot.addWidget(widget)
    widget.resize(900, widget.heightForWidth(900))
    widget.show()
    return widget


def view_of(strip):
    return strip.findChild(QListView)


def middle_of(strip, row):
    view = view_of(strip)
    rect = view.visualRect(view.model().index(row, 0))
    return rect.center()


def color_at(strip, row):
    at = middle_of(strip, row)
    image = view_of(strip).viewport().grab().toImage()
    return image.pixelColor(at.x() + 30, at.y() - 20).getRgb()[:3]


def test_it_fills_as_pictures_arrive_in_the_expected_order(qtbot, strip, pictures):
    strip.set_pictures([], CAPTIONS)
    assert [picture.path for picture in strip.pictures] == [None] * 6
    strip.set_pictures([pictures[3], pictures[1]], CAPTIONS)
    assert [picture.caption for picture in strip.pictures] == CAPTIONS
    qtbot.waitUntil(lambda: color_at(strip, 3) == (120, 100, 50))
    qtbot.waitUntil(lambda: color_at(strip, 1) == (40, 100, 50))
    strip.set_pictures(pictures, CAPTIONS)
    qtbot.waitUntil(lambda: color_at(strip, 2) == (80, 100, 50))


def test_unexpected_pictures_come_last(strip, pictures):
    strip.set_pictures([pictures[5], pictures[0]], CAPTIONS[:2])
    assert [picture.caption for picture in strip.pictures] == ["pour 0", "pour 1", "pour 5"]


def test_a_click_opens_it_large_and_arrows_go_on_over_what_is_missing(qtbot, strip, pictures):
    strip.set_pictures([pictures[0], pictures[2], pictures[5]], CAPTIONS)
    with qtbot.waitSignal(strip.activated) as heard:
        qtbot.mouseClick(view_of(strip).viewport(), LEFT, pos=middle_of(strip, 2))
    assert heard.args == [2]
    dialog = strip.findChild(PictureDialog)
    assert dialog.index == 2
    qtbot.keyClick(dialog, Qt.Key.Key_Right)
    assert dialog.index == 5
    assert not dialog.findChild(QPushButton, "picture_next").isEnabled()
    qtbot.keyClick(dialog, Qt.Key.Key_Left)
    qtbot.keyClick(dialog, Qt.Key.Key_Left)
    assert dialog.index == 0
    assert "pour 0" in dialog.findChild(QLabel, "picture_caption").text()
    dialog.accept()


def test_it_opens_again_after_closing(qtbot, strip, pictures):
    strip.set_pictures(pictures)
    for row in (0, 1):
        with qtbot.waitSignal(strip.activated):
            qtbot.mouseClick(view_of(strip).viewport(), LEFT, pos=middle_of(strip, row))
        dialog = strip.findChild(PictureDialog)
        with qtbot.waitSignal(dialog.destroyed):
            dialog.accept()


def test_what_is_awaited_cannot_be_opened(qtbot, strip):
    strip.set_pictures([], CAPTIONS)
    with qtbot.assertNotEmitted(strip.activated):
        qtbot.mouseClick(view_of(strip).viewport(), LEFT, pos=middle_of(strip, 1))


def test_the_large_picture_is_shown_and_a_broken_one_is_named(qtbot, pictures, tmp_path):
    broken = Picture("broken", tmp_path / "gone.png")
    dialog = PictureDialog([pictures[4], broken], 0)
    qtbot.addWidget(dialog)
    dialog.show()

    def middle():
        image = dialog.grab().toImage()
        return image.pixelColor(image.width() // 3, image.height() // 3).getRgb()[:3]

    qtbot.waitUntil(lambda: middle() == (160, 100, 50))
    dialog.show_picture(1)
    qtbot.waitUntil(lambda: middle() != (160, 100, 50))


@pytest.mark.parametrize(("width_px", "n"), [(763, 7), (763, 24), (763, 30), (1250, 7), (1250, 30)])
def test_all_pictures_are_seen_at_once_and_can_be_clicked(qtbot, strip, pictures, width_px, n):
    shown = [Picture(str(k + 1), pictures[k % 6].path) for k in range(n)]
    strip.set_pictures(shown)
    strip.resize(width_px, strip.heightForWidth(width_px))
    qtbot.wait(20)
    view = view_of(strip)
    places = [view.visualRect(view.model().index(row, 0)) for row in range(n)]
    assert all(view.viewport().rect().contains(place) for place in places)
    assert not view.horizontalScrollBar().isVisible()
    assert not any(a.intersects(b) for a, b in pairwise(places))
    words = QFontMetrics(smaller(view.font()))
    assert min(place.width() for place in places) >= words.horizontalAdvance("30") + 6
    assert view.verticalScrollBar().maximum() == 0
    assert strip.height() <= strip.sizeHint().height()  # no more is taken from the 3D view above it
    with qtbot.waitSignal(strip.activated) as heard:
        qtbot.mouseClick(view.viewport(), LEFT, pos=places[-1].center())
    assert heard.args == [n - 1]
    strip.findChild(PictureDialog).accept()


def test_the_arrow_keys_walk_through_both_rows_and_enter_opens(qtbot, strip, pictures):
    strip.set_pictures([Picture(str(k + 1), pictures[k % 6].path) for k in range(30)])
    strip.resize(763, strip.heightForWidth(763))
    qtbot.wait(20)
    view = view_of(strip)
    view.setCurrentIndex(view.model().index(0, 0))
    for _ in range(16):
        qtbot.keyClick(view, Qt.Key.Key_Right)
    assert view.currentIndex().row() == 16
    qtbot.keyClick(view, Qt.Key.Key_Up)
    assert view.currentIndex().row() == 1
    with qtbot.waitSignal(strip.activated) as heard:
        qtbot.keyClick(view, Qt.Key.Key_Return)
    assert heard.args == [1]
    strip.findChild(PictureDialog).accept()


def test_few_pictures_stay_as_large_as_they_are_meant_to_be(qtbot, strip, pictures):
    strip.set_pictures(pictures)
    strip.resize(1250, strip.heightForWidth(1250))
    qtbot.wait(20)
    assert middle_of(strip, 1).x() - middle_of(strip, 0).x() == round(96 * 4 / 3) + 6


def test_filling_it_does_not_scroll_it_back(qtbot, strip, pictures):
    strip.resize(100, strip.heightForWidth(100))  # too narrow for all at a glance
    strip.set_pictures(pictures[:2], CAPTIONS)
    qtbot.wait(20)
    bar = view_of(strip).horizontalScrollBar()
    bar.setValue(bar.maximum())
    place = bar.value()
    assert place > 100
    strip.set_pictures(pictures, CAPTIONS)
    qtbot.wait(20)
    assert bar.value() == place
