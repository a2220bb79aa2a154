from __future__ import annotations

import csv
import io

import pytest
from PySide6.QtCore import QItemSelectionModel, Qt
from PySide6.QtGui import QGuiApplication

from app.gui.views.fact_table import Column, FactTable, Row

COLUMNS = (
    Column("View", align="left"),
    Column("Shift", "mm", tooltip="How far the pose was corrected"),
    Column("Points", decimals=0),
    Column("Good"),
)
ROWS = (
    Row(("b", 2.345678, 12000, True), tooltip="second"),
    Row(("a", 10.0, 900, False), tooltip="first", needs_attention=True),
    Row(("c", None, 50, True)),
)


@pytest.fixture
def table(qtbot):
    widget = FactTable(COLUMNS)
    qtbot.addWidget(widget)
    widget.resize(500, 200)
    widget.set_rows(ROWS)
    widget.show()
    return widget


def column(table, k, role=Qt.ItemDataRole.DisplayRole):
    return [table.model().index(row, k).data(role) for row in range(table.model().rowCount())]


def sort_by(qtbot, table, k):
    header = table.horizontalHeader()
    at = header.rect().center()
    at.setX(header.sectionViewportPosition(k) + header.sectionSize(k) // 2)
    qtbot.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)


def test_values_are_written_with_units_in_the_header(table):
    assert table.model().headerData(1, Qt.Orientation.Horizontal) == "Shift (mm)"
    assert column(table, 1) == ["2.35", "10.00", "--"]
    assert column(table, 2) == ["12 000", "900", "50"]
    assert column(table, 3) == ["yes", "no", "yes"]
    assert column(table, 0, Qt.ItemDataRole.ToolTipRole) == ["second", "first", None]


def test_a_click_sorts_numbers_as_numbers_with_nothing_last(qtbot, table):
    assert column(table, 0) == ["b", "a", "c"]  # as given, until somebody clicks
    sort_by(qtbot, table, 1)
    assert column(table, 1) == ["2.35", "10.00", "--"]
    sort_by(qtbot, table, 1)
    assert column(table, 1) == ["10.00", "2.35", "--"]
    sort_by(qtbot, table, 2)
    assert column(table, 2) == ["50", "900", "12 000"]


def test_the_picked_row_is_reported_by_its_place_in_the_order_given(qtbot, table):
    sort_by(qtbot, table, 0)
    at = table.visualRect(table.model().index(0, 1)).center()
    with qtbot.waitSignal(table.row_selected) as heard:
        qtbot.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, pos=at)
    assert heard.args == [1]
    assert table.rows[table.selected_row].values[0] == "a"


def test_selecting_from_outside_sends_nothing(qtbot, table):
    with qtbot.assertNotEmitted(table.row_selected):
        table.select_row(2)
    assert table.selected_row == 2
    table.select_row(None)
    assert table.selected_row is None


def test_copying_gives_csv_with_all_digits_in_the_order_shown(qtbot, table):
    sort_by(qtbot, table, 0)
    qtbot.keyClick(table, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    lines = list(csv.reader(io.StringIO(QGuiApplication.clipboard().text())))
    assert lines[0] == ["View", "Shift (mm)", "Points", "Good"]
    assert lines[1] == ["a", "10.0", "900", "False"]
    assert lines[2][1] == "2.345678"
    assert lines[3] == ["c", "", "50", "True"]


def test_a_row_to_look_at_is_marked_and_says_so(table):
    texts = column(table, 0, Qt.ItemDataRole.AccessibleTextRole)
    assert texts == [None, "a, needs attention", None]
    assert table.has_marks
    marked = table.grab().toImage()
    table.set_rows([Row(row.values) for row in ROWS])
    assert not table.has_marks
    assert table.grab().toImage() != marked


def test_nothing_can_be_edited(table):
    assert not table.model().flags(table.model().index(0, 0)) & Qt.ItemFlag.ItemIsEditable


def test_a_table_that_gets_the_focus_picks_nothing(qtbot, table):
    table.window().show()
    with qtbot.assertNotEmitted(table.row_selected):
        table.setFocus()
        table.setCurrentIndex(table.model().index(-1, -1))
        table.selectionModel().setCurrentIndex(
            table.model().index(0, 0), QItemSelectionModel.SelectionFlag.NoUpdate
        )
