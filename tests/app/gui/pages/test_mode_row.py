import pytest
from PySide6.QtWidgets import QPushButton

from app.gui.pages.mode_row import ModeRow


@pytest.fixture
def row(qtbot):
    row = ModeRow("mode")
    qtbot.addWidget(row)
    for key in ("shape", "height", "parts"):
        row.add(key, key.title(), f"Show {key}")
    return row


def button(row, key):
    return row.findChild(QPushButton, f"mode_{key}")


def test_the_first_mode_is_down_until_another_is_clicked(row, qtbot):
    assert row.mode == "shape"
    assert button(row, "shape").isChecked()
    with qtbot.waitSignal(row.chosen) as told:
        button(row, "height").click()
    assert told.args == ["height"]
    assert [key for key in ("shape", "height", "parts") if button(row, key).isChecked()] == ["height"]


def test_a_mode_that_is_down_stays_so_without_being_told_again(row, qtbot):
    with qtbot.assertNotEmitted(row.chosen):
        button(row, "shape").click()
    assert button(row, "shape").isChecked()


def test_a_mode_that_goes_leaves_its_place_to_the_first(row):
    row.choose("parts")
    row.set_available("parts", False, "There are none")
    assert row.mode == "shape"
    assert not button(row, "parts").isEnabled()
    assert button(row, "parts").toolTip() == "There are none"
