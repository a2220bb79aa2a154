"""What each set of parameters is worth, a row each."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QWidget

from app.calibration_board import Board
from app.gui.pages.calibration.measure_words import measure_title
from app.gui.pages.calibration.table import differences_text
from app.gui.views.health_table import Column, FactTable, Row
from core.parameters import Parameters


class SummaryTable(FactTable):
    """One row for each set: what judges, accuracy, the two objects that decide the margin, the threshold."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(_columns(), parent)
        self.setObjectName("sets_table")
        self.setAccessibleName(self.tr("Sets of parameters"))

    def show_board(self, board: Board | None) -> None:
        """Show a board's sets; the selection stays where it can."""
        selected = self.selected_row
        rows = [] if board is None else [_row(board, k) for k in range(len(board.sets))]
        self.set_rows(rows)
        if selected is not None and selected < len(rows):
            self.select_row(selected)


def _columns() -> list[Column]:
    def tr(text: str) -> str:
        return QCoreApplication.translate("SummaryTable", text)

    return [
        Column(tr("Set"), align="left"),
        Column(tr("Judged by"), tooltip=tr("What is held against the threshold"), align="left"),
        Column(tr("Right"), tooltip=tr("Objects judged as they are labelled; ambiguous ones do not count")),
        Column(
            tr("Margin"), tooltip=tr("Smallest container less largest other; negative: overlap"), decimals=3
        ),
        Column(tr("Threshold"), tooltip=tr("Above it an object is a container"), decimals=3),
        Column(tr("Smallest container"), tooltip=tr("The container with the smallest score"), align="left"),
        Column(tr("Largest other"), tooltip=tr("The non-container with the largest score"), align="left"),
    ]


def _row(board: Board, k: int) -> Row:
    one = board.sets[k]
    found = board.score(one)
    right = "--" if found.accuracy is None else f"{found.n_right} / {found.n_judged}, {found.accuracy:.1%}"
    right = right.replace("%", " %")
    if found.n_failed:
        right += QCoreApplication.translate("SummaryTable", ", {n} failed").format(n=found.n_failed)
    tip = differences_text(one.parameters, Parameters())
    name = one.name
    if one.provenance is not None:
        name = QCoreApplication.translate("SummaryTable", "{name}, fitted").format(name=name)
        tip = f"{one.provenance.sentence}\n{tip}"
    return Row(
        (
            name,
            measure_title(one.measure),
            right,
            found.margin,
            one.threshold,
            _named(found.smallest_container),
            _named(found.largest_other),
        ),
        tooltip=tip or QCoreApplication.translate("SummaryTable", "as the default"),
        needs_attention=found.margin is not None and found.margin <= 0,
    )


def _named(extreme: tuple[float, str] | None) -> str | None:
    return None if extreme is None else f"{extreme[0]:.3f}  {extreme[1]}"
