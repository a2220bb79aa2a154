import pytest
from PySide6.QtWidgets import QLabel

from app.gui.pages.fact_grid import Fact, FactGrid


@pytest.fixture
def grid(qtbot):
    grid = FactGrid("facts")
    qtbot.addWidget(grid)
    return grid


def words(grid, qtbot):
    qtbot.wait(1)  # labels that went are deleted later
    return [label.text() for label in grid.findChildren(QLabel)]


def test_what_was_before_has_its_column_only_where_there_is_something_in_it(grid, qtbot):
    grid.set_facts([Fact("Volume", "140 ml"), Fact("Faces", "9 186")])
    assert words(grid, qtbot) == ["Volume", "140 ml", "Faces", "9 186"]
    grid.set_facts([Fact("Volume", "134 ml", before="140 ml")])
    assert words(grid, qtbot) == ["now", "last", "Volume", "134 ml", "140 ml"]


def test_a_fact_says_what_it_means(grid):
    grid.set_facts([Fact("Seed", "0", "Of all randomness")])
    assert {label.toolTip() for label in grid.findChildren(QLabel)} == {"Of all randomness"}
