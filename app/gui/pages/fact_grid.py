"""A few facts, one a row: what it is, its value, and what it was before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.painting import tabular


@dataclass(frozen=True)
class Fact:
    """A row.

    Attributes:
        title: what it is.
        value: with its unit.
        tooltip: what it means and where it comes from.
        before: its value in the last result; empty if there is none to compare with.
        is_wide: whether the value also takes the column of what was before.
        is_beside: whether it lies beside the fact before it, unless a column says what was before.
    """

    title: str
    value: str
    tooltip: str = ""
    before: str = ""
    is_wide: bool = False
    is_beside: bool = False


class FactGrid(QWidget):
    """Rows of facts; the column with what was before is there when there is something in it."""

    def __init__(self, name: str, per_row: int = 1) -> None:
        """Make an empty grid; only with one fact per row there is a column for what was before."""
        super().__init__()
        self.setObjectName(name)
        self._facts: tuple[Fact, ...] = ()
        self._per_row = per_row
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(2 * GRID_PX // per_row)
        self._grid.setVerticalSpacing(GRID_PX // 2)
        self._grid.setColumnStretch(3, 1)
        self._grid.setColumnStretch(1, per_row - 1)

    @property
    def facts(self) -> tuple[Fact, ...]:
        """What is shown."""
        return self._facts

    def set_facts(self, facts: Sequence[Fact]) -> None:
        """Show other facts."""
        if tuple(facts) == self._facts:
            return
        self._facts = tuple(facts)
        while (item := self._grid.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.deleteLater()
        has_before = any(fact.before for fact in facts)
        if has_before:
            self._put(0, 1, self.tr("now"), "muted")
            self._put(0, 2, self.tr("last"), "muted")
        row, column = 0, 0
        for k, fact in enumerate(facts):
            is_beside = bool(k % self._per_row) or (fact.is_beside and not has_before)
            row, column = (row, column + 2) if is_beside else (row + 1, 0)
            follows = k + 1 < len(facts) and facts[k + 1].is_beside
            is_wide = fact.is_wide or (self._per_row == 1 and not has_before and not column and not follows)
            self._put(row, column, fact.title, "muted", fact.tooltip)
            self._put(row, column + 1, fact.value, "", fact.tooltip, 3 if is_wide else 1)
            self._put(row, column + 2, fact.before, "muted", fact.tooltip)

    def _put(self, row: int, column: int, text: str, role: str, tip: str = "", span: int = 1) -> None:
        if not text:
            return
        label = QLabel(text)
        label.setToolTip(tip)
        label.setWordWrap(span > 1)
        if role:
            label.setProperty("role", role)
        if column:
            label.setFont(tabular(self.font()))
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        top = Qt.AlignmentFlag.AlignTop if not column else Qt.AlignmentFlag(0)
        self._grid.addWidget(label, row, column, 1, span, top)
