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


def test_short_facts_share_a_row_unless_there_is_something_of_before(grid, qtbot):
    def tops():
        qtbot.wait(1)
        return {label.text(): label.y() for label in grid.findChildren(QLabel)}

    facts = [Fact("Holds", "312 candies"), Fact("Seed", "0"), Fact("Took", "1.2 s", is_beside=True)]
    grid.resize(300, 100)
    grid.show()
    grid.set_facts(facts)
    assert tops()["Took"] == tops()["Seed"] > tops()["Holds"]
    assert words(grid, qtbot) == ["Holds", "312 candies", "Seed", "0", "Took", "1.2 s"]
    grid.set_facts([Fact("Holds", "312 candies", before="300"), *facts[1:]])
    assert tops()["Took"] > tops()["Seed"]
