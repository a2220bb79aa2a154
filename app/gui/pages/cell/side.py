"""The right of the Cell page: which cell, its steps, and what the chosen step needs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.cell.crop_form import CropForm
from app.gui.pages.cell.cup_form import CupForm
from app.gui.pages.cell.step_list import StepList
from app.gui.pages.cell.touch_form import TouchForm
from app.gui.pages.layouts import row_of
from app.gui.pages.page import SidePanel
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, rule, say, text_label
from app.operations.calibration import step_names
from core.calibration.board import DICTIONARIES, BoardSpec

MM = 1000.0
_NEW, _SHIPPED = "\0new", ""
"""Of the entries that are no file."""


class CellSide(SidePanel):
    """The controls of the page.

    Signals: `cell_wanted` with a cell's file, none for the one that the program ships; `new_wanted` when
    another one is to be made.

    Attributes:
        form: for a new cell.
        steps: of the cell that is shown.
        options: of the chosen step.
        undo: takes back the chosen step.
        start_over: leaves an interrupted calibration aside.
        live: shows what the camera sees now.
    """

    cell_wanted = Signal(object)
    new_wanted = Signal()

    def __init__(self) -> None:
        super().__init__("")
        self._combo = QComboBox()
        self._combo.setObjectName("cell")
        self._combo.setAccessibleName(self.tr("Cell"))
        self._combo.activated.connect(self._pick)
        self.form, self.steps, self.options = NewCellForm(), StepList(), StepOptions()
        self._title, self._what = heading(""), text_label("step_what")
        self._figure = text_label("step_figure", "muted")
        self._obstacle = text_label("obstacle", "attention")
        self.undo = self._button("undo", self.tr("Undo"))
        self.undo.setToolTip(self.tr("Put back what was there before; what was recorded stays"))
        self.start_over = self._button("start_over", self.tr("Start over"))
        self.start_over.setToolTip(self.tr("Leave the views of the interrupted calibration aside"))
        self.live = self._button("live", self.tr("Live view"))
        self.live.setToolTip(self.tr("Show colour and depth as the camera sees them, until it is cancelled"))
        for button in (self.undo, self.start_over, self.live):
            button.setMinimumHeight(self.primary.minimumHeight())
            self.add_button(button)
        self._line = rule()
        for widget in (
            self._combo, self.form, self.steps, self._line, self._title, self._what, self._figure,
            self.options, self._obstacle,
        ):  # fmt: skip
            self.body.addWidget(widget)
        self.body.addStretch(1)

    def show_cells(self, known: Sequence[Path], chosen: Path | None, is_new: bool) -> None:
        """Offer cells' files; the chosen one, or the entry for a new one, is shown."""
        paths = [*known, *([chosen] if chosen is not None and chosen not in known else [])]
        with QSignalBlocker(self._combo):
            self._combo.clear()
            self._combo.addItem(self.tr("Built-in simulated cell"), _SHIPPED)
            for path in paths:
                self._combo.addItem(path.stem, str(path))
            self._combo.insertSeparator(self._combo.count())
            self._combo.addItem(self.tr("New cell …"), _NEW)
            wanted = _NEW if is_new else _SHIPPED if chosen is None else str(chosen)
            self._combo.setCurrentIndex(self._combo.findData(wanted))
        self._combo.setToolTip("" if chosen is None else str(chosen))

    def show_step(self, title: str, what: str, figure: str) -> None:
        """Say what the chosen step is about."""
        is_other = title != self._title.text()
        self._line.setVisible(bool(title))
        say(self._title, title)
        say(self._what, what)
        say(self._figure, figure)
        if is_other and self.options.isVisibleTo(self):
            self.reveal(self.options)

    def show_obstacle(self, text: str) -> None:
        """Say what keeps the step from being done."""
        say(self._obstacle, text)

    def _pick(self, index: int) -> None:
        picked = self._combo.itemData(index)
        if picked == _NEW:
            self.new_wanted.emit()
        elif picked is not None:
            self.cell_wanted.emit(Path(picked) if picked else None)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(text)
        return button


class NewCellForm(QWidget):
    """Name and kind of a new cell.

    Signals: `changed` when something was typed or chosen.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("new_cell")
        self._name = QLineEdit(self.tr("my cell"))
        self._name.setObjectName("cell_name")
        self._kind = QComboBox()
        self._kind.setObjectName("cell_kind")
        self._kind.addItem(self.tr("Simulated, to rehearse in"), True)
        self._kind.addItem(self.tr("A real UR5 with a camera"), False)
        self._address = QLineEdit()
        self._address.setObjectName("cell_address")
        self._address.setPlaceholderText("192.168.0.10")
        self._form = QFormLayout()
        self._form.setSpacing(GRID_PX)
        self._form.addRow(self.tr("Name"), self._name)
        self._form.addRow(self.tr("Kind"), self._kind)
        self._form.addRow(self.tr("Controller's address"), self._address)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, GRID_PX, 0, GRID_PX)
        column.setSpacing(GRID_PX)
        column.addWidget(heading(self.tr("A new cell")))
        column.addWidget(
            text_label(
                "new_cell_what",
                text=self.tr(
                    "Its file is written at once, and each step completes it. In a simulated cell the camera "
                    "hangs a little beside where the file has it: the calibration has to find out where."
                ),
            )
        )
        column.addLayout(self._form)
        self._kind.currentIndexChanged.connect(self._show_kind)
        for edit in (self._name, self._address):
            edit.textChanged.connect(lambda _: self.changed.emit())
        self._show_kind()

    @property
    def name(self) -> str:
        """As typed."""
        return self._name.text().strip()

    @property
    def is_simulated(self) -> bool:
        """Whether it has no devices."""
        return bool(self._kind.currentData())

    @property
    def address(self) -> str | None:
        """Of a real arm's controller."""
        return None if self.is_simulated else self._address.text().strip()

    @property
    def is_complete(self) -> bool:
        """Whether a cell can be made of it."""
        return bool(self.name) and (self.is_simulated or bool(self.address))

    def _show_kind(self) -> None:
        self._form.setRowVisible(self._address, not self.is_simulated)
        self.changed.emit()


class StepOptions(QStackedWidget):
    """What the chosen step may be told.

    Signals: `print_wanted` when the board is to be printed.

    Attributes:
        crop: the box that holds the object.
        cup: where it stands, and how large it is.
        touch: a corner of the board, with the tip of the hand.
    """

    print_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._pages: dict[str, QWidget] = {}
        self._side = _millimetres("square_measured", 5, 200, 30.0)
        self._printed = _millimetres("square_printed", 5, 200, 30.0)
        self._columns, self._rows = _count("board_columns", 3, 20, 8), _count("board_rows", 3, 20, 5)
        self._paper, self._dictionary = QComboBox(), QComboBox()
        self._n_views = _count("n_looks", 6, 60, 20)
        self._thickness = _millimetres("thickness", 0, 50, 4.0)
        self._n_scan_views = _count("n_scan_views", 6, 200, 24)
        self._add("", QFormLayout())
        self._add(step_names.BOARD, self._board_form())
        self._add(step_names.HAND_EYE, _form(self.tr("Views"), self._n_views))
        self.crop = CropForm()
        table = _form(self.tr("Thickness of the board"), self._thickness)
        table.addRow(self.crop)
        self._add(step_names.TABLE, table)
        self.cup = CupForm()
        cup = QFormLayout()
        cup.addRow(self.cup)
        self._add(step_names.CUP, cup)
        self.touch = TouchForm()
        touch = QFormLayout()
        touch.addRow(self.touch)
        self._add(step_names.CHECK, touch)
        self._add(step_names.VIEWS, _form(self.tr("Views at most"), self._n_scan_views))

    def show_step(self, step: str) -> None:
        """Show what a step may be told."""
        page = self._pages.get(step, self._pages[""])
        self.setCurrentWidget(page)
        self.setVisible(step in self._pages and bool(step))
        self.setFixedHeight(page.sizeHint().height())

    def show_board(self, board: BoardSpec, is_measured: bool) -> None:
        """Show the board that is entered."""
        self._columns.setValue(board.columns)
        self._rows.setValue(board.rows)
        self._dictionary.setCurrentText(board.dictionary)
        self._side.setValue(board.square_m * MM)
        if not is_measured:
            self._printed.setValue(board.square_m * MM)

    @property
    def printed_board(self) -> BoardSpec:
        """The board as it is to be printed; raises `InputError` if it cannot be."""
        return self._board(self._printed.value() / MM)

    @property
    def measured_board(self) -> BoardSpec:
        """The board as it was printed; raises `InputError` if it cannot be."""
        return self._board(self.measured_m)

    @property
    def measured_m(self) -> float:
        """Side of a square, as it was measured."""
        return self._side.value() / MM

    @property
    def paper(self) -> str:
        """To print on."""
        return str(self._paper.currentData())

    @property
    def n_views(self) -> int:
        """How many views of the board are wanted."""
        return self._n_views.value()

    @property
    def thickness_m(self) -> float:
        """Of the board with what it is glued to."""
        return self._thickness.value() / MM

    @property
    def n_scan_views(self) -> int:
        """How many views a scan has at most."""
        return self._n_scan_views.value()

    def _board(self, square_m: float) -> BoardSpec:
        return BoardSpec(self._columns.value(), self._rows.value(), square_m, self._dictionary.currentText())

    def _board_form(self) -> QFormLayout:
        self._paper.setObjectName("paper")
        self._paper.addItem("A4", "a4")
        self._paper.addItem(self.tr("Letter"), "letter")
        self._dictionary.setObjectName("dictionary")
        self._dictionary.addItems(list(DICTIONARIES))
        self._dictionary.setCurrentText(BoardSpec().dictionary)
        wanted = QPushButton(self.tr("Print …"))
        wanted.setObjectName("print_board")
        wanted.setToolTip(self.tr("Writes a PDF beside the cell's file, and opens it"))
        wanted.clicked.connect(self.print_wanted)
        form = QFormLayout()
        form.addRow(self.tr("Squares"), row_of(self._columns, self._rows, self._printed))
        form.addRow(self.tr("Markers"), row_of(self._dictionary))
        form.addRow(self.tr("Paper"), row_of(self._paper, wanted))
        form.addRow(self.tr("Measured"), row_of(self._side))
        return form

    def _add(self, step: str, form: QFormLayout) -> None:
        page = QWidget()
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(GRID_PX)
        page.setLayout(form)
        self._pages[step] = page
        self.addWidget(page)


def _form(title: str, box: QWidget) -> QFormLayout:
    form = QFormLayout()
    form.addRow(title, row_of(box))
    return form


def _millimetres(name: str, least: float, most: float, value: float) -> QDoubleSpinBox:
    box = QDoubleSpinBox()
    box.setObjectName(name)
    box.setRange(least, most)
    box.setDecimals(2)
    box.setSingleStep(0.05)
    box.setSuffix(" mm")
    box.setValue(value)
    return box


def _count(name: str, least: int, most: int, value: int) -> QSpinBox:
    box = QSpinBox()
    box.setObjectName(name)
    box.setRange(least, most)
    box.setValue(value)
    return box
