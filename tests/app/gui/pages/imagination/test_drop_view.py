import pytest
from PIL import Image
from PySide6.QtWidgets import QLabel, QPushButton

from app.gui.pages.imagination.view import PicturesPart


@pytest.fixture
def part(qtbot):
    part = PicturesPart()
    qtbot.addWidget(part)
    part.show()
    return part


@pytest.fixture
def files(tmp_path):
    paths = [tmp_path / name for name in ("drop_1_start.png", "drop_2_falling.png", "pours.png")]
    for path in paths:
        Image.new("RGB", (64, 48)).save(path)
    return paths


def said(part):
    return part.findChild(QLabel, "pictures_said").text()


def test_without_pictures_there_is_the_button_and_no_strip(part, qtbot):
    part.show_none("Not drawn yet.")
    assert said(part) == "Not drawn yet."
    assert not part.strip.isVisible()
    with qtbot.waitSignal(part.render_wanted):
        part.button.click()


def test_the_strip_fills_in_the_order_of_the_drop(part, files):
    part.show_drawing(files[1:2], with_pours=True)
    assert said(part) == "Rendering pictures: 1 of 7"
    captions = [picture.caption for picture in part.strip.pictures]
    assert captions == ["Start", "Falling", "Settled", "Tilted", "Pushed", "End", "All pours"]
    assert [picture.path for picture in part.strip.pictures] == [None, files[1], *[None] * 5]


def test_without_pours_no_sheet_of_them_is_awaited(part):
    part.show_drawing([], with_pours=False)
    assert len(part.strip.pictures) == 6


def test_drawn_pictures_are_all_there_and_films_have_their_buttons(part, files, tmp_path):
    film = tmp_path / "drop.mp4"
    film.write_bytes(b"")
    part.show_drawn([film, *files])
    assert [picture.caption for picture in part.strip.pictures] == ["Start", "Falling", "All pours"]
    assert part.findChild(QPushButton, "drop_film").isVisible()
    assert not part.findChild(QPushButton, "pour_film").isVisible()
