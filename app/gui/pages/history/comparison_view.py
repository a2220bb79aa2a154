"""Two sessions side by side: their cards, and line by line what they share and what differs."""

from __future__ import annotations

from functools import cache
from itertools import groupby

from PySide6.QtCore import QCoreApplication, QEvent, Qt, Signal
from PySide6.QtGui import QFont, QKeySequence, QPixmap, QResizeEvent, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)
from typing_extensions import override

from app.gui.desk.stage_words import stage_words
from app.gui.pages.history.card_painter import CardFace
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import make_bare, tabular
from app.gui.views.parameter_editor.naming import group_title, titles
from app.library.compare import Comparison, Row
from core.parameters import describe

WHAT, MARK, A, B, DIFFERENCE = range(5)
_MOST_SHARE = 0.27
"""Of the width, for the names of the lines; longer ones wrap."""
_DIFFERS, _SAME = "≠", "="


class ComparisonView(QWidget):
    """Shows a `Comparison`.

    Signals: `left` when Escape says that the user has seen enough.
    """

    left = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("comparison")
        self._comparison: Comparison | None = None
        self._a, self._b = CardFace("card_a"), CardFace("card_b")
        self._table = _table()
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, 0)
        column.setSpacing(GRID_PX)
        column.addLayout(self._build_head())
        faces = QHBoxLayout()
        faces.setSpacing(GRID_PX)
        faces.addWidget(self._a)
        faces.addWidget(self._b)
        column.addLayout(faces)
        column.addWidget(self._table, 1)

    @property
    def comparison(self) -> Comparison | None:
        """What is shown."""
        return self._comparison

    def show_comparison(self, comparison: Comparison) -> None:
        """Show two sessions, as yet without pictures."""
        self._comparison = comparison
        n = sum(not row.is_same for row in comparison.rows)
        self._said.setText(
            self.tr("{n} of {all} lines differ ({mark})").format(n=n, all=len(comparison.rows), mark=_DIFFERS)
        )
        self._fill()

    def show_pictures(self, a: QPixmap | None, b: QPixmap | None) -> None:
        """Show the two cards with what pictures there are by now."""
        if self._comparison is not None:
            self._a.show_session(self._comparison.a, a)
            self._b.show_session(self._comparison.b, b)

    def _build_head(self) -> QHBoxLayout:
        title = QLabel(self.tr("Two sessions compared"))
        title.setProperty("role", "title")
        self._said = QLabel()
        self._said.setObjectName("comparison_count")
        self._said.setProperty("role", "muted")
        self._only = QCheckBox(self.tr("Only differences"))
        self._only.setObjectName("only_differences")
        self._only.setToolTip(self.tr("Hide what is the same in both sessions."))
        self._only.toggled.connect(lambda _: self._fill())
        leave = QShortcut(QKeySequence(QKeySequence.StandardKey.Cancel), self)
        leave.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        leave.activated.connect(self.left)
        row = QHBoxLayout()
        row.setSpacing(2 * GRID_PX)
        row.addWidget(title)
        row.addWidget(self._said, 1)
        row.addWidget(self._only)
        return row

    def _fill(self) -> None:
        comparison = self._comparison
        if comparison is None:
            return
        names = [comparison.a.name, comparison.b.name]
        if names[0] == names[1]:  # the folders tell them apart
            names = [comparison.a.path.name, comparison.b.path.name]
        self._table.setHorizontalHeaderLabels(["", "", *names, self.tr("Difference")])
        rows = [row for row in comparison.rows if not (self._only.isChecked() and row.is_same)]
        self._table.clearSpans()
        self._table.setRowCount(0)
        for group, members in groupby(rows, key=lambda row: row.group):
            self._add_group(group)
            for row in members:
                self._add_row(row)
        self._fit()

    def _fit(self) -> None:
        """Leave the values most of the room."""
        most_px = round(_MOST_SHARE * self._table.viewport().width())
        self._table.setColumnWidth(WHAT, min(self._table.sizeHintForColumn(WHAT), most_px))
        self._table.resizeRowsToContents()

    def _add_group(self, group: str) -> None:
        number = self._table.rowCount()
        self._table.insertRow(number)
        self._table.setItem(number, WHAT, _item(_group_words(group), self._bold()))
        self._table.setSpan(number, WHAT, 1, DIFFERENCE + 1)

    def _add_row(self, row: Row) -> None:
        number = self._table.rowCount()
        self._table.insertRow(number)
        theme = theme_of(self)
        mark = _item(
            _SAME if row.is_same else _DIFFERS, tabular(self.font()) if row.is_same else self._bold()
        )
        mark.setTextAlignment(Qt.AlignmentFlag.AlignCenter)
        mark.setForeground(theme.color("muted" if row.is_same else "accent"))
        mark.setToolTip(self.tr("the same in both") if row.is_same else self.tr("differs"))
        self._table.setItem(number, MARK, mark)
        for column, text in (
            (WHAT, _what_words(row)),
            (A, row.a),
            (B, row.b),
            (DIFFERENCE, row.difference),
        ):
            item = _item(text, tabular(self.font()))
            item.setForeground(theme.color("muted" if row.is_same or column == WHAT else "text"))
            item.setToolTip(_explained(row) if column == WHAT else text)
            self._table.setItem(number, column, item)

    def _bold(self) -> QFont:
        return tabular(self.font(), bold=True)

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._fill()


def _table() -> QTableWidget:
    table = QTableWidget(0, DIFFERENCE + 1)
    table.setObjectName("comparison_table")
    table.setAccessibleName(QCoreApplication.translate("History", "What the two sessions share and do not"))
    table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
    table.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
    table.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    table.setShowGrid(False)
    table.setWordWrap(True)
    table.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
    table.verticalHeader().hide()
    make_bare(table)
    table.setStyleSheet(f"{table.styleSheet()} QTableWidget::item {{ padding: 3px 0; }}")
    table.verticalHeader().setMinimumSectionSize(3 * GRID_PX)
    header = table.horizontalHeader()
    header.setMinimumSectionSize(3 * GRID_PX)
    header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    header.setHighlightSections(False)
    header.setSectionResizeMode(WHAT, QHeaderView.ResizeMode.Fixed)
    for column in (MARK, DIFFERENCE):
        header.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)
    for column in (A, B):
        header.setSectionResizeMode(column, QHeaderView.ResizeMode.Stretch)
    return table


def _item(text: str, font: QFont) -> QTableWidgetItem:
    item = QTableWidgetItem(text)
    item.setFont(font)
    item.setTextAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    return item


def _group_words(group: str) -> str:
    translate = QCoreApplication.translate
    words = {
        "Object": translate("History", "Object"),
        "Imagination": translate("History", "Imagination"),
        "Pour": translate("History", "Pour"),
        "Time": translate("History", "Time that each step took"),
        "Parameters": translate("History", "Parameters"),
    }
    return words.get(group, group)


@cache
def _parameter_titles() -> dict[str, str]:
    return titles(describe())


def _what_words(row: Row) -> str:
    if row.group == "Time":
        return stage_words(row.what)
    if row.group == "Parameters" and row.what in _parameter_titles():
        return f"{group_title(row.what.partition('.')[0])}: {_parameter_titles()[row.what]}"
    return row.what[:1].upper() + row.what[1:]


def _explained(row: Row) -> str:
    """What a line means, where its name does not say it."""
    translate = QCoreApplication.translate
    words = {
        "Omega": translate("History", "Share of the dropped candies that stayed, 0 to 1 (Eq. 1)."),
        "threshold of Omega": translate("History", "It is an open container if Omega is larger."),
        "chosen pour": translate(
            "History", "The direction is anticlockwise from the base's x-axis, the distance from the middle."
        ),
        "best P": translate("History", "Share of the poured candies that land inside, at the best place."),
        "P of the chosen pour": translate(
            "History", "Share of the poured candies that land inside, at the chosen place."
        ),
    }
    return words.get(row.what, row.what)
