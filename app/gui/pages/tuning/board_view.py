"""The large view: the objects with their scores by each set of parameters, and what each set is worth."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, QSize, Qt, Signal
from PySide6.QtGui import QIcon, QImage, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QPushButton,
    QSplitter,
    QStackedWidget,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.tuning.fit_texts import differences_text, measure_meaning, measure_noun, object_title
from app.gui.pages.tuning.object_pictures import PICTURE_PX
from app.gui.pages.tuning.score_cell import CELL_ROLE, ScoreCell, ScoreDelegate
from app.gui.theme import GRID_PX
from app.gui.views.fact_table import Column, FactTable, Row
from app.gui.views.labels import heading, place_text, text_label
from app.gui.views.painting import tabular
from app.operations.tuning_board import Board, ParameterSet
from core.evaluation.labels import LABELS, LabelledObject
from core.evaluation.verdicts import ObjectVerdict, is_right
from core.parameters import Parameters
from core.report.sentences import duration_text

_SET_PX, _SETS_PX = 136, 140


class ObjectTable(QTreeWidget):
    """One row for each object, one column for each set, grouped by label; rows can be selected to be run."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("objects_table")
        self.setAccessibleName(self.tr("Objects and their scores"))
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setAlternatingRowColors(True)
        self.setIconSize(QSize(*PICTURE_PX))
        self.setIndentation(16)
        self.setFrameShape(QTreeWidget.Shape.NoFrame)
        self.setItemDelegate(ScoreDelegate(self))
        self.setFont(tabular(self.font()))
        self.header().setStretchLastSection(False)
        self.header().setMinimumSectionSize(_SET_PX)
        self._rows: dict[str, QTreeWidgetItem] = {}
        self._objects: tuple[LabelledObject, ...] = ()
        self._show_heads(())

    def selected_names(self) -> tuple[str, ...]:
        """Return the selected objects, in their order; a selected group counts as all of its objects."""
        wanted = {item.data(0, CELL_ROLE) for item in self.selectedItems()}
        return tuple(one.name for one in self._objects if wanted & {one.name, f"group {one.label}"})

    def show_board(self, board: Board | None) -> None:
        """Show another board, or none."""
        objects = () if board is None else board.objects
        if objects != self._objects:
            self._objects = objects
            self._build_rows()
        self._show_heads(() if board is None else board.sets)
        if board is not None:
            for one in objects:
                self._show_row(board, one)

    def show_picture(self, name: str, picture: QImage) -> None:
        """Show what an object looks like."""
        if name in self._rows:
            self._rows[name].setIcon(0, QIcon(QPixmap.fromImage(picture)))

    def show_verdict(self, board: Board, name: str) -> None:
        """Update one object."""
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
            group.setFont(0, tabular(self.font(), bold=True))
            for one in members:
                row = self._rows[one.name] = QTreeWidgetItem(group, [object_title(one)])
                row.setData(0, CELL_ROLE, one.name)
                row.setToolTip(0, "\n".join(filter(None, (one.name, one.category, one.notes, str(one.mesh)))))
            group.setFirstColumnSpanned(True)
            group.setExpanded(True)

    def _show_heads(self, sets: tuple[ParameterSet, ...]) -> None:
        """Each set's name and, below, what it judges by; how it differs is said in the tooltip."""
        heads = [f"{one.name}\n{measure_noun(one.measure)}" for one in sets]
        self.setColumnCount(1 + len(sets))
        self.setHeaderLabels([self.tr("Object"), *heads])
        self.header().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        for column, one in enumerate(sets, 1):
            text = differences_text(one.parameters, Parameters()) or self.tr("nothing")
            tip = self.tr("{meaning} {name} differs from the default in:\n{text}")
            lines = [tip.format(meaning=measure_meaning(one.measure), name=one.name, text=text)]
            if column > 1:
                text = differences_text(one.parameters, sets[0].parameters) or self.tr("nothing")
                lines.append(self.tr("and from {name} in:\n{text}").format(name=sets[0].name, text=text))
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
            row.setText(column, cell.text)
            row.setData(column, CELL_ROLE, cell)
            row.setTextAlignment(column, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            row.setToolTip(column, self._tip(verdict, each, is_flipped))
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
        if verdict.measure == "Omega":
            said = self.tr("{n_in} of {n_drop} candies stayed; the threshold is {threshold:.3g}.")
        else:
            said = self.tr(
                "Hollow for {share:.1f} % of its bulk; the threshold is {threshold:.3g}. "
                "{n_in} of {n_drop} dropped candies stayed."
            )
        flip = self.tr("⇄ The verdict differs from that of the set before.") if is_flipped else ""
        return " ".join(filter(None, (said, self.tr("It took {time}."), flip))).format(
            n_in=verdict.n_in,
            n_drop=verdict.n_drop,
            share=100 * verdict.score,
            threshold=each.threshold,
            time=duration_text(verdict.seconds),
        )


class SummaryTable(FactTable):
    """One row for each set: what judges, accuracy, the two objects that decide the margin, the threshold."""

    def __init__(self) -> None:
        right = _tr("Objects judged as they are labelled; ambiguous ones do not count")
        margin = _tr("Smallest score of a container minus the largest of another object")
        super().__init__(
            [
                Column(_tr("Set"), align="left"),
                Column(_tr("Judged by"), tooltip=_tr("What is compared with the threshold"), align="left"),
                Column(_tr("Right"), tooltip=right),
                Column(_tr("Margin"), tooltip=margin, decimals=3),
                Column(_tr("Threshold"), tooltip=_tr("Above it an object is a container"), decimals=3),
                Column(_tr("Smallest container"), tooltip=_tr("The lowest container score"), align="left"),
                Column(_tr("Largest other"), tooltip=_tr("The highest other score"), align="left"),
            ]
        )
        self.setObjectName("sets_table")
        self.setAccessibleName(self.tr("Sets of parameters"))

    def show_board(self, board: Board | None) -> None:
        """Show a board's sets; the selection stays where it can."""
        selected = self.selected_row
        rows = [] if board is None else [self._row(board, one) for one in board.sets]
        self.set_rows(rows)
        if selected is not None and selected < len(rows):
            self.select_row(selected)

    def _row(self, board: Board, one: ParameterSet) -> Row:
        found = board.score(one)
        right = (
            "--" if found.accuracy is None else f"{found.n_right} / {found.n_judged}, {found.accuracy:.1%}"
        )
        right = right.replace("%", " %")
        if found.n_failed:
            right += self.tr(", {n} failed").format(n=found.n_failed)
        name, tip = one.name, differences_text(one.parameters, Parameters()) or self.tr("the default")
        if one.provenance is not None:
            name = self.tr("{name}, fitted").format(name=name)
            tip = f"{one.provenance.sentence}\n{tip}"
        noun = measure_noun(one.measure)
        extremes = (found.ends.smallest_container, found.ends.largest_other)
        titles = {each.name: object_title(each) for each in board.objects}
        named = (None if end is None else f"{end[0]:.3f}  {titles.get(end[1], end[1])}" for end in extremes)
        values = (name, noun[:1].upper() + noun[1:], right, found.ends.value, one.threshold, *named)
        return Row(
            values, tooltip=tip, needs_attention=found.ends.value is not None and found.ends.value <= 0
        )


class BoardView(QWidget):
    """Shows a board.

    Attributes:
        objects: the table of objects.
        sets: the table of sets.
        choose_wanted: another folder of objects.
        export_wanted: the table as CSV.
        remove_wanted: index of the set to remove.
        set_selected: index of the set that was picked.
    """

    choose_wanted = Signal()
    export_wanted = Signal()
    remove_wanted = Signal(int)
    set_selected = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.objects = ObjectTable()
        self.sets = SummaryTable()
        self._hint = text_label("tuning_hint")
        self._hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._hint.setMargin(4 * GRID_PX)
        self._stack = QStackedWidget()
        self._stack.addWidget(self._hint)
        self._stack.addWidget(self._build_tables())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._build_bar())
        column.addWidget(self._stack, 1)
        self.sets.row_selected.connect(self._select)

    def _build_bar(self) -> QWidget:
        self._source = text_label("objects_folder")
        self._choose = _button("choose_objects", self.tr("Choose objects…"))
        self._choose.setToolTip(self.tr("A folder of meshes with a CSV file of labels: id, label"))
        self._choose.clicked.connect(self.choose_wanted)
        self._export = _button("export_csv", self.tr("Export CSV…"))
        self._export.clicked.connect(self.export_wanted)
        return _bar(self._source, self._choose, self._export)

    def _build_tables(self) -> QSplitter:
        self._remove = _button("remove_set", self.tr("Remove set"))
        self._remove.setToolTip(
            self.tr("Remove the selected set from the table; its results stay on the disk")
        )
        self._remove.clicked.connect(self._ask_removal)
        below = QWidget()
        column = QVBoxLayout(below)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(_bar(heading(self.tr("Sets of parameters")), self._remove))
        column.addWidget(self.sets, 1)
        tables = QSplitter(Qt.Orientation.Vertical)
        tables.setChildrenCollapsible(False)
        tables.setHandleWidth(1)
        tables.addWidget(self.objects)
        tables.addWidget(below)
        tables.setStretchFactor(0, 1)
        tables.setStretchFactor(1, 0)
        tables.setSizes([1000, _SETS_PX])
        return tables

    def show_board(self, board: Board | None, hint: str = "") -> None:
        """Show a board; without one the hint says what will be here."""
        self._hint.setText(hint)
        self._stack.setCurrentIndex(0 if board is None else 1)
        self._export.setEnabled(board is not None and bool(board.sets))
        self._source.setText("" if board is None else place_text(board.source))
        self._source.setToolTip("" if board is None else str(board.source))
        self.objects.show_board(board)
        self.sets.show_board(board)
        self.update_buttons()

    def update_buttons(self, is_idle: bool = True) -> None:
        """Enable what can be done now."""
        self._choose.setEnabled(is_idle)
        self._remove.setEnabled(is_idle and self.sets.selected_row is not None)

    def _select(self, index: int) -> None:
        self.update_buttons()
        self.set_selected.emit(index)

    def _ask_removal(self) -> None:
        row = self.sets.selected_row
        if row is not None:
            self.remove_wanted.emit(row)


def _tr(text: str) -> str:
    return QCoreApplication.translate("Tuning", text)


def _button(name: str, text: str) -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(name)
    return button


def _bar(first: QWidget, *others: QWidget) -> QWidget:
    """A line of widgets, of which the first takes what is left."""
    bar = QWidget()
    row = QHBoxLayout(bar)
    row.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
    row.setSpacing(GRID_PX)
    row.addWidget(first, 1)
    for widget in others:
        row.addWidget(widget)
    return bar
