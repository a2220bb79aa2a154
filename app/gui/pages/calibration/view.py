"""The large view: the table of objects above the summary of the sets, or what to do first."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSplitter,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.calibration_board import Board
from app.gui.pages.calibration.summary import SummaryTable
from app.gui.pages.calibration.table import ObjectTable
from app.gui.theme import GRID_PX


class CalibrationView(QWidget):
    """Shows a board.

    Attributes:
        objects: the table of objects.
        sets: the table of sets.
        choose_wanted: another folder of objects.
        export_wanted: the table as CSV.
        remove_wanted: index of the set that shall go.
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
        self._stack = QStackedWidget()
        self._hint = QLabel()
        self._hint.setObjectName("calibration_hint")
        self._hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._hint.setWordWrap(True)
        self._hint.setMargin(4 * GRID_PX)
        self._stack.addWidget(self._hint)
        self._stack.addWidget(self._build_tables())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._build_bar())
        column.addWidget(self._stack, 1)
        self.sets.row_selected.connect(self._select)

    def _build_bar(self) -> QWidget:
        bar = QWidget()
        self._source = QLabel()
        self._source.setObjectName("objects_folder")
        self._source.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._choose = QPushButton(self.tr("Choose objects..."))
        self._choose.setObjectName("choose_objects")
        self._choose.setToolTip(self.tr("A folder of meshes with a CSV of labels: id, label"))
        self._choose.clicked.connect(lambda: self.choose_wanted.emit())
        self._export = QPushButton(self.tr("Export CSV..."))
        self._export.setObjectName("export_csv")
        self._export.clicked.connect(lambda: self.export_wanted.emit())
        row = QHBoxLayout(bar)
        row.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
        row.setSpacing(GRID_PX)
        row.addWidget(self._source, 1)
        row.addWidget(self._choose)
        row.addWidget(self._export)
        return bar

    def _build_tables(self) -> QSplitter:
        below = QWidget()
        self._remove = QPushButton(self.tr("Remove set"))
        self._remove.setObjectName("remove_set")
        self._remove.setToolTip(
            self.tr("Take the selected set out of the table; its results stay on the disk")
        )
        self._remove.clicked.connect(self._ask_removal)
        title = QLabel(self.tr("Sets of parameters"))
        title.setProperty("role", "heading")
        head = QHBoxLayout()
        head.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
        head.addWidget(title, 1)
        head.addWidget(self._remove)
        column = QVBoxLayout(below)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(head)
        column.addWidget(self.sets, 1)
        tables = QSplitter(Qt.Orientation.Vertical)
        tables.setChildrenCollapsible(False)
        tables.setHandleWidth(1)
        tables.addWidget(self.objects)
        tables.addWidget(below)
        tables.setStretchFactor(0, 1)
        tables.setStretchFactor(1, 0)
        tables.setSizes([1000, 176])
        return tables

    def show_board(self, board: Board | None, hint: str = "") -> None:
        """Show a board; without one the hint says what will be here."""
        self._hint.setText(hint)
        self._stack.setCurrentIndex(0 if board is None else 1)
        self._export.setEnabled(board is not None and bool(board.sets))
        text = "" if board is None else str(board.source)
        self._source.setText(text)
        self._source.setToolTip(text)
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
