"""A read-only table of facts: sorted by a click, copied as CSV, with a mark on rows that need attention."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from PySide6.QtCore import (
    QItemSelection,
    QModelIndex,
    QPersistentModelIndex,
    QPointF,
    QRectF,
    QSignalBlocker,
    QSortFilterProxyModel,
    Qt,
    Signal,
)
from PySide6.QtGui import (
    QGuiApplication,
    QKeyEvent,
    QKeySequence,
    QPainter,
    QPolygonF,
    QStandardItem,
    QStandardItemModel,
)
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from app.gui.theme import GRID_PX, Theme, theme_of
from app.gui.views.painting import draw_elided, tabular

_Index = QModelIndex | QPersistentModelIndex
_SORT = Qt.ItemDataRole.UserRole
_ATTENTION = Qt.ItemDataRole.UserRole + 1
_MARK_PX = 14
_AIR_PX = 6
_LAST_PX = 96
"""The last column is at least this wide, and takes what is left."""


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes:
        title: what it is.
        unit: of its numbers, shown in the header.
        tooltip: what it means and where it comes from.
        align: "left" or "right".
        decimals: of its numbers as shown; the CSV has all digits.
    """

    title: str
    unit: str = ""
    tooltip: str = ""
    align: Literal["left", "right"] = "right"
    decimals: int = 2

    @property
    def heading(self) -> str:
        """Title and unit."""
        return f"{self.title} ({self.unit})" if self.unit else self.title


@dataclass(frozen=True)
class Row:
    """A row.

    Attributes:
        values: one for each column: text, a number, a yes/no, or None where there is nothing.
        tooltip: of the whole row.
        needs_attention: whether it is marked.
    """

    values: tuple[Any, ...]
    tooltip: str = ""
    needs_attention: bool = False


class _Sorted(QSortFilterProxyModel):
    """Numbers as numbers, text as text, nothing last."""

    def lessThan(self, left: _Index, right: _Index) -> bool:
        a, b = left.data(_SORT), right.data(_SORT)
        if a is None or b is None:
            is_up = self.sortOrder() == Qt.SortOrder.AscendingOrder
            return (b is None and a is not None) if is_up else (a is None and b is not None)
        if isinstance(a, str) or isinstance(b, str):
            return str(a).casefold() < str(b).casefold()
        return bool(a < b)


class _Delegate(QStyledItemDelegate):
    """Padded text; in the first column behind a mark, or its width left free, if any row has one."""

    def __init__(self, view: FactTable) -> None:
        super().__init__(view)
        self._view = view

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        shown = QStyleOptionViewItem(option)
        self.initStyleOption(shown, index)
        text = shown.text
        shown.text = ""
        style = self._view.style()
        style.drawControl(QStyle.ControlElement.CE_ItemViewItem, shown, painter, self._view)
        box = QRectF(shown.rect).adjusted(_AIR_PX, 0, -_AIR_PX, 0)
        if index.column() == 0 and self._view.has_marks:
            mark = QRectF(box.left(), box.top(), _MARK_PX, box.height())
            box.setLeft(mark.right() + _AIR_PX)
            if index.data(_ATTENTION):
                paint_attention(painter, mark, theme_of(self._view))
        theme = theme_of(self._view)
        ink = "on_accent" if shown.state & QStyle.StateFlag.State_Selected else "text"
        painter.save()
        painter.setFont(shown.font)
        painter.setPen(theme.color(ink if self._view.isEnabled() else "muted"))
        draw_elided(painter, box, text, shown.displayAlignment)
        painter.restore()


def paint_attention(painter: QPainter, box: QRectF, theme: Theme) -> None:
    """Paint the attention mark: a triangle with an exclamation mark."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    center = box.center()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(theme.color("attention"))
    corners = [QPointF(0, -6), QPointF(6.5, 5.5), QPointF(-6.5, 5.5)]
    painter.drawPolygon(QPolygonF([center + corner for corner in corners]))
    painter.setBrush(theme.color("surface"))
    painter.drawRect(QRectF(center.x() - 0.8, center.y() - 2.5, 1.6, 4.2))
    painter.drawEllipse(center + QPointF(0, 3.6), 0.9, 0.9)
    painter.restore()


class FactTable(QTableView):
    """Rows keep the order they are given in until a header is clicked.

    Attributes:
        row_selected: the index (in the order given) of the row the user picked; not sent by `select_row`.
        has_marks: whether any row needs attention.
    """

    row_selected = Signal(int)

    def __init__(self, columns: Sequence[Column], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("fact_table")
        self.has_marks = False
        self._is_grown = False
        self._columns = tuple(columns)
        self._rows: tuple[Row, ...] = ()
        self._model = QStandardItemModel(self)
        for k, column in enumerate(columns):
            self._model.setHorizontalHeaderItem(k, _item(column.heading, column, column.tooltip))
        self._sorted = _Sorted(self)
        self._sorted.setSourceModel(self._model)
        self.setModel(self._sorted)
        self.setItemDelegate(_Delegate(self))
        self.setFont(tabular(self.font()))
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setFrameShape(QTableView.Shape.NoFrame)
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(False)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + GRID_PX)
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        header.setStretchLastSection(True)
        self._sorted.sort(-1)
        header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        header.setSortIndicatorClearable(True)
        self.setSortingEnabled(True)
        # Not when a row becomes current: a table that gets the focus makes its first row current.
        self.selectionModel().selectionChanged.connect(self._emit_row)

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows in the order they were given."""
        return self._rows

    @property
    def selected_row(self) -> int | None:
        """The index, in the order given, of the selected row."""
        index = self.currentIndex()
        return self._sorted.mapToSource(index).row() if index.isValid() else None

    def set_rows(self, rows: Sequence[Row]) -> None:
        """Show other rows, in the order the user sorted them by."""
        self._rows = tuple(rows)
        self.has_marks = any(row.needs_attention for row in rows)
        self._model.setRowCount(0)
        for row in rows:
            self._model.appendRow(self._items(row))
        if self._is_grown:
            self._grow()
        *firsts, last = range(len(self._columns))
        for column in firsts:
            self.setColumnWidth(column, self._fitting_width(column))
        self.setColumnWidth(last, min(self._fitting_width(last), _LAST_PX))  # it takes the rest anyway

    def grow_with_rows(self) -> None:
        """Be as high as all rows from now on, and scroll nothing: what the table is in does."""
        self._is_grown = True
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._grow()

    def _grow(self) -> None:
        heading = self.horizontalHeader().sizeHint().height()
        rows = len(self._rows) * self.verticalHeader().defaultSectionSize()
        self.setFixedHeight(heading + rows + GRID_PX // 2)

    def _items(self, row: Row) -> list[QStandardItem]:
        items = []
        for value, column in zip(row.values, self._columns, strict=True):
            item = _item(self._text(value, column), column, row.tooltip)
            item.setData(value, _SORT)
            items.append(item)
        if row.needs_attention:
            items[0].setData(True, _ATTENTION)
            items[0].setAccessibleText(self.tr("{text}, needs attention").format(text=items[0].text()))
        return items

    def _text(self, value: Any, column: Column) -> str:
        """A value as it is read."""
        if value is None:
            return "--"
        if isinstance(value, bool):
            return self.tr("yes") if value else self.tr("no")
        if isinstance(value, int):
            return f"{value:,}".replace(",", " ")
        if isinstance(value, float):
            return f"{value:.{column.decimals}f}"
        return str(value)

    def _fitting_width(self, column: int) -> int:
        title = self._columns[column].heading
        marks = _MARK_PX + _AIR_PX if column == 0 and self.has_marks else 0
        widest = max(
            self.sizeHintForColumn(column) + marks, round(1.1 * self.fontMetrics().horizontalAdvance(title))
        )
        return widest + 3 * _AIR_PX

    def select_row(self, index: int | None) -> None:
        """Select a row by its place in the order given, without a signal."""
        with QSignalBlocker(self.selectionModel()):
            if index is None:
                self.selectionModel().clear()
            else:
                self.selectRow(self._sorted.mapFromSource(self._model.index(index, 0)).row())
        self.viewport().update()

    def csv(self) -> str:
        """Return the table as CSV in the order shown, numbers in full."""
        out = io.StringIO()
        writer = csv.writer(out)
        writer.writerow([column.heading for column in self._columns])
        for shown in range(self._sorted.rowCount()):
            row = self._rows[self._sorted.mapToSource(self._sorted.index(shown, 0)).row()]
            writer.writerow(["" if value is None else value for value in row.values])
        return out.getvalue()

    def _emit_row(self, selected: QItemSelection, _deselected: QItemSelection) -> None:
        if selected.indexes():
            self.row_selected.emit(self._sorted.mapToSource(selected.indexes()[0]).row())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Copy the table as CSV by Ctrl+C."""
        if event.matches(QKeySequence.StandardKey.Copy):
            QGuiApplication.clipboard().setText(self.csv())
        else:
            super().keyPressEvent(event)


def _item(text: str, column: Column, tooltip: str) -> QStandardItem:
    item = QStandardItem(text)
    side = Qt.AlignmentFlag.AlignLeft if column.align == "left" else Qt.AlignmentFlag.AlignRight
    item.setTextAlignment(side | Qt.AlignmentFlag.AlignVCenter)
    item.setEditable(False)
    if tooltip:
        item.setToolTip(tooltip)
    return item
