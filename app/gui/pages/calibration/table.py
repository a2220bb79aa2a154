"""The table of objects: one row each, one column for each set of parameters, grouped by label."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem
from typing_extensions import override

from app.calibration_board import Board, ParameterSet
from app.gui.pages.calibration.measure_words import measure_meaning, measure_noun
from app.gui.pages.calibration.score_cell import CELL_ROLE, ScoreCell, ScoreDelegate
from app.gui.views.painting import tabular
from core.evaluation.labels import LABELS, LabelledObject
from core.evaluation.scores import is_right
from core.evaluation.verdicts import ObjectVerdict
from core.parameters import Parameters, difference

_OBJECT_PX, _SET_PX, _WIDEST_SET_PX = 192, 136, 360


class ObjectTable(QTreeWidget):
    """Shows a board; rows can be selected to be run."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("objects_table")
        self.setAccessibleName(self.tr("Objects and their scores"))
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setAlternatingRowColors(True)
        self.setUniformRowHeights(True)
        self.setRootIsDecorated(True)
        self.setIndentation(16)
        self.setFrameShape(QTreeWidget.Shape.NoFrame)
        self.setItemDelegate(ScoreDelegate(self))
        self.setFont(tabular(self.font()))
        self._rows: dict[str, QTreeWidgetItem] = {}
        self._objects: tuple[LabelledObject, ...] = ()
        self._sets: tuple[ParameterSet, ...] = ()
        self.setHeaderLabels([self.tr("Object")])

    def selected_names(self) -> tuple[str, ...]:
        """Return the selected objects, in their order; a selected group stands for all of it."""
        wanted = {item.data(0, CELL_ROLE) for item in self.selectedItems()}
        return tuple(one.name for one in self._objects if wanted & {one.name, f"group {one.label}"})

    def show_board(self, board: Board | None) -> None:
        """Show another board, or none."""
        objects = () if board is None else board.objects
        if objects != self._objects:
            self._objects = objects
            self._build_rows()
        sets = () if board is None else board.sets
        if _heads(sets) != _heads(self._sets) or not self._sets:
            self._build_columns(sets)
        self._sets = sets
        if board is not None:
            for one in board.objects:
                self._show_row(board, one)
            self._show_heads(board)

    def show_verdict(self, board: Board, name: str) -> None:
        """Show one object anew."""
        one = next((each for each in board.objects if each.name == name), None)
        if one is not None and name in self._rows:
            self._show_row(board, one)

    def _build_rows(self) -> None:
        self.clear()
        self._rows = {}
        titles = {
            "container": self.tr("Containers ({n})"),
            "non-container": self.tr("Not containers ({n})"),
            "ambiguous": self.tr("Ambiguous, not counted ({n})"),
        }
        for label in LABELS:
            members = [one for one in self._objects if one.label == label]
            if not members:
                continue
            group = QTreeWidgetItem(self, [titles[label].format(n=len(members))])
            group.setData(0, CELL_ROLE, f"group {label}")
            font = self.font()
            font.setBold(True)
            group.setFont(0, font)
            for one in members:
                self._rows[one.name] = self._new_row(group, one)
            group.setFirstColumnSpanned(True)
            group.setExpanded(True)

    def _new_row(self, group: QTreeWidgetItem, one: LabelledObject) -> QTreeWidgetItem:
        row = QTreeWidgetItem(group, [one.name])
        row.setData(0, CELL_ROLE, one.name)
        row.setToolTip(0, "\n".join(filter(None, (one.category, one.notes, str(one.mesh)))))
        return row

    def _build_columns(self, sets: tuple[ParameterSet, ...]) -> None:
        self.setColumnCount(1 + len(sets))
        self.setHeaderLabels([self.tr("Object"), *_heads(sets)])
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        self._fit_columns()

    def _fit_columns(self) -> None:
        """Give the sets what the objects leave."""
        n = self.columnCount() - 1
        width = self.viewport().width()
        object_px = max(_OBJECT_PX, width // 5)
        self.setColumnWidth(0, object_px)
        if n > 0:
            share = (width - object_px) // n
            for column in range(1, 1 + n):
                self.setColumnWidth(column, min(max(share, _SET_PX), _WIDEST_SET_PX))

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_columns()

    def _show_heads(self, board: Board) -> None:
        first = board.sets[0].parameters if board.sets else Parameters()
        for column, one in enumerate(board.sets, 1):
            text = differences_text(one.parameters, Parameters())
            tip = self.tr("{meaning} {name} differs from the default in:\n{text}")
            meaning = measure_meaning(one.measure)
            lines = [tip.format(meaning=meaning, name=one.name, text=text or self.tr("nothing"))]
            if column > 1:
                against = differences_text(one.parameters, first) or self.tr("nothing")
                said = self.tr("and from {name} in:\n{text}")
                lines.append(said.format(name=board.sets[0].name, text=against))
            self.headerItem().setToolTip(column, "\n".join(lines))

    def _show_row(self, board: Board, one: LabelledObject) -> None:
        row = self._rows[one.name]
        before: bool | None = None
        for column, each in enumerate(board.sets, 1):
            verdict = board.of(each).get(one.name)
            score = None if verdict is None else verdict.score
            is_open = None if score is None else score > each.threshold
            is_flipped = None not in (before, is_open) and before != is_open
            cell = self._cell(one, each, verdict, is_flipped)
            row.setData(column, CELL_ROLE, cell)
            row.setToolTip(column, self._tip(verdict, each, is_flipped))
            row.setData(column, Qt.ItemDataRole.AccessibleTextRole, self._words(cell))
            before = is_open if is_open is not None else before

    def _cell(
        self, one: LabelledObject, each: ParameterSet, verdict: ObjectVerdict | None, is_flipped: bool
    ) -> ScoreCell:
        if verdict is None:
            return ScoreCell(None, each.threshold, None)
        if verdict.score is None:
            return ScoreCell(None, each.threshold, None, self.tr("failed"))
        right = is_right(one.label, verdict.score, each.threshold)
        word = self.tr("wrong") if right is False else ""
        return ScoreCell(verdict.score, each.threshold, right, word, is_flipped)

    def _tip(self, verdict: ObjectVerdict | None, each: ParameterSet, is_flipped: bool) -> str:
        if verdict is None:
            return self.tr("Not judged yet.")
        if verdict.score is None:
            return verdict.problem
        said = self._found_words(verdict).format(
            n_in=verdict.n_in,
            n_drop=verdict.n_drop,
            share=100 * verdict.score,
            threshold=each.threshold,
            seconds=verdict.seconds,
        )
        flip = self.tr("The verdict flips against the set before.")
        return f"{said} {flip}" if is_flipped else said

    def _found_words(self, verdict: ObjectVerdict) -> str:
        if verdict.measure == "Omega":
            return self.tr(
                "{n_in} of {n_drop} candies stayed; the threshold is {threshold:.3g}. "
                "It took {seconds:.1f} s."
            )
        return self.tr(
            "What it holds fills {share:.1f} % of its convex hull; the threshold is {threshold:.3g}. Of the "
            "{n_drop} candies dropped {n_in} stayed. It took {seconds:.1f} s."
        )

    def _words(self, cell: ScoreCell) -> str:
        number = self.tr("not judged") if cell.score is None else f"{cell.score:.3f}"
        flip = self.tr("flips") if cell.is_flipped else ""
        return ", ".join(filter(None, (number, cell.word, flip)))

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.viewport().update()


def _heads(sets: tuple[ParameterSet, ...]) -> list[str]:
    """Heading of each set: its name and, below, what it judges by."""
    return [f"{one.name}\n{measure_noun(one.measure)}" for one in sets]


def differences_text(parameters: Parameters, base: Parameters) -> str:
    """Return what differs, a line each."""
    return "\n".join(
        f"{name} = {after:.6g}" if isinstance(after, float) else f"{name} = {after}"
        for name, (_, after) in difference(parameters, base).items()
    )
