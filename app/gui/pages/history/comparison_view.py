"""Two sessions side by side: their cards, then their models and pours, or line by line what differs."""

from __future__ import annotations

from functools import cache
from itertools import groupby

from PySide6.QtCore import QCoreApplication, QEvent, Qt, Signal
from PySide6.QtGui import QFont, QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QHBoxLayout,
    QHeaderView,
    QStackedWidget,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)
from typing_extensions import override

from app.gui.desk.stage_words import stage_words
from app.gui.pages.history.cards import CardList
from app.gui.pages.history.compared_models import ComparedModel
from app.gui.pages.history.comparison_pictures import ComparisonPictures
from app.gui.pages.mode_row import ModeRow
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.labels import text_label
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

    Signals: `left` when the user pressed Escape.

    Attributes:
        comparison: what is shown; none at first.
        cards: the two sessions.
        pictures: their models and pours.
    """

    left = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.comparison: Comparison | None = None
        self.cards = CardList(n_columns=2)
        self.cards.setObjectName("compared_cards")
        self.cards.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.cards.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.cards.setFixedHeight(self.cards.card_height_px)
        self._table = _table()
        self.pictures = ComparisonPictures()
        self._below = QStackedWidget()
        self._below.addWidget(self.pictures)
        self._below.addWidget(self._table)
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, 0)
        column.setSpacing(GRID_PX)
        column.addLayout(self._build_head())
        column.addWidget(self.cards)
        column.addWidget(self._below, 1)

    def show_comparison(self, comparison: Comparison) -> None:
        """Show two sessions."""
        self.comparison = comparison
        self.pictures.clear()
        self.cards.show_sessions((comparison.a, comparison.b))
        n = sum(not row.is_same for row in comparison.rows)
        said = self.tr("{n} of {all} lines differ ({mark})")
        self._count.setText(said.format(n=n, all=len(comparison.rows), mark=_DIFFERS))
        self._fill()

    def show_models(self, models: tuple[ComparedModel, ComparedModel]) -> None:
        """Show the two sessions' models and pours, unless others are compared by now."""
        comparison = self.comparison
        if comparison is not None and [model.folder for model in models] == [
            comparison.a.path,
            comparison.b.path,
        ]:
            self.pictures.show_models(models)

    def _choose(self, mode: str) -> None:
        self._below.setCurrentWidget(self._table if mode == "lines" else self.pictures)
        if mode != "lines":
            self.pictures.setCurrentIndex(("models", "pours").index(mode))
        self._only.setVisible(mode == "lines")

    def _build_modes(self) -> ModeRow:
        modes = ModeRow("comparison")
        modes.add("models", self.tr("Models"), self.tr("Both from the same place, at the same scale"))
        modes.add("pours", self.tr("Pours"), self.tr("The two wheels of imagined pours"))
        modes.add("lines", self.tr("Line by line"), self.tr("What the two share, and what differs"))
        modes.chosen.connect(self._choose)
        return modes

    def _build_head(self) -> QHBoxLayout:
        title = text_label("", "title", self.tr("Two sessions compared"))
        title.setWordWrap(False)
        self._count = text_label("comparison_count", "muted")
        self._only = QCheckBox(self.tr("Only differences"))
        self._only.setObjectName("only_differences")
        self._only.setToolTip(self.tr("Hide what is the same in both sessions"))
        self._only.toggled.connect(lambda _: self._fill())
        self._only.hide()
        leave = QShortcut(QKeySequence(QKeySequence.StandardKey.Cancel), self)
        leave.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        leave.activated.connect(self.left)
        row = QHBoxLayout()
        row.setSpacing(2 * GRID_PX)
        row.addWidget(title)
        row.addWidget(self._count, 1)
        row.addWidget(self._only)
        row.addWidget(self._build_modes())
        return row

    def _fill(self) -> None:
        comparison = self.comparison
        if comparison is None:
            return
        names = [comparison.a.name, comparison.b.name]
        if names[0] == names[1]:  # the folders differ
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
        """Leave most of the width to the values."""
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
        theme, font = theme_of(self), tabular(self.font())
        mark_font = font if row.is_same else self._bold()
        same = self.tr("the same in both") if row.is_same else self.tr("differs")
        value_ink = "muted" if row.is_same else "text"
        for column, text, tip, ink in (
            (WHAT, _what_words(row), _explained(row), "muted"),
            (MARK, _SAME if row.is_same else _DIFFERS, same, "muted" if row.is_same else "accent"),
            (A, row.a, row.a, value_ink),
            (B, row.b, row.b, value_ink),
            (DIFFERENCE, row.difference, row.difference, value_ink),
        ):
            item = _item(text, mark_font if column == MARK else font)
            item.setForeground(theme.color(ink))
            item.setToolTip(tip)
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
    table.setAccessibleName(
        QCoreApplication.translate("History", "What the two sessions share, and what differs")
    )
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
        "Time": translate("History", "Time each step took"),
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
