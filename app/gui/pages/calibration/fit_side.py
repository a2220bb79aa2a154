"""What to fit to what: parameters, objects, seeds, trials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFormLayout,
    QGridLayout,
    QLabel,
    QPushButton,
    QSpinBox,
    QWidget,
)

from app.gui.pages.calibration.fit_words import fitted_tip, fitted_title, range_text
from app.gui.pages.calibration.measure_words import measure_noun
from app.gui.pages.page import SidePanel
from app.gui.theme import GRID_PX
from app.gui.views.painting import tabular
from core.evaluation.fitting.fitted import CONTAINABILITY, FittedParameter, fitted_parameters
from core.evaluation.labels import LabelledObject
from core.evaluation.trials import Measure

_OFFERED = (
    *CONTAINABILITY,
    "containability.contact.restitution",
    "particle.diameter_m",
    "particle.height_m",
)
_SEEDS, _TRIALS = 3, 40


@dataclass(frozen=True)
class FitWishes:
    """What was chosen.

    Attributes:
        fitted: parameters, maybe none.
        is_all: whether all labelled objects are taken, marked for calibration or not.
        source: whether objects are scanned or their meshes are known.
        n_seeds: at least one.
        n_trials: at least one.
    """

    fitted: tuple[FittedParameter, ...]
    is_all: bool
    source: Literal["mesh", "scan"]
    n_seeds: int
    n_trials: int


class FitSide(SidePanel):
    """The choices of a fit.

    Attributes:
        back_wanted: to the objects.
        changed: something else was chosen.
    """

    back_wanted = Signal()
    changed = Signal()

    def __init__(self) -> None:
        super().__init__("")
        self.primary.setText(self.tr("Fit"))
        self.primary.setObjectName("fit_start")
        back = QPushButton(self.tr("Back to objects"))
        back.setObjectName("fit_back")
        back.setMinimumHeight(5 * GRID_PX)
        back.clicked.connect(lambda: self.back_wanted.emit())
        self.add_button(back)
        self._objects_note = QLabel()
        self._objects_note.setObjectName("fit_objects")
        self._objects_note.setWordWrap(True)
        self._measure_note = QLabel()
        self._all = QCheckBox(self.tr("All labelled objects"))
        self._all.setObjectName("fit_all")
        self._all.setToolTip(self.tr("Not only those whose column 'calib' says so"))
        self._all.toggled.connect(lambda: self.changed.emit())
        self._boxes: dict[FittedParameter, QCheckBox] = {}
        self._choices = QWidget()
        self._build()

    def _build(self) -> None:
        self.body.addWidget(self._heading(self.tr("Fit to labels")))
        self.body.addWidget(self._objects_note)
        self.body.addWidget(self._all)
        self.body.addSpacing(GRID_PX)
        self.body.addWidget(self._heading(self.tr("Parameters")))
        self.body.addLayout(self._build_parameters())
        self._measure_note.setObjectName("fit_measure")
        self._measure_note.setProperty("role", "muted")
        self._measure_note.setWordWrap(True)
        self.body.addWidget(self._measure_note)
        self.body.addSpacing(GRID_PX)
        self.body.addWidget(self._heading(self.tr("Search")))
        self.body.addLayout(self._build_search())
        self.body.addStretch(1)

    def _heading(self, text: str) -> QLabel:
        label = QLabel(text)
        label.setProperty("role", "heading")
        return label

    def _build_parameters(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(GRID_PX)
        grid.setVerticalSpacing(GRID_PX // 2)
        grid.setColumnStretch(0, 1)
        for row, one in enumerate(fitted_parameters(_OFFERED)):
            box = QCheckBox(fitted_title(one))
            box.setObjectName(f"fit_{one.name}")
            box.setChecked(one.name in CONTAINABILITY)
            box.setToolTip(fitted_tip(one))
            box.toggled.connect(lambda: self.changed.emit())
            where = QLabel(range_text(one))
            where.setFont(tabular(self.font()))
            where.setProperty("role", "muted")
            where.setToolTip(
                self.tr("Looked for in this range; 'poursight calibrate --parameter' takes others")
            )
            grid.addWidget(box, row, 0)
            grid.addWidget(where, row, 1, Qt.AlignmentFlag.AlignRight)
            self._boxes[one] = box
        return grid

    def _build_search(self) -> QFormLayout:
        self._source = QComboBox()
        self._source.setObjectName("fit_input")
        self._source.addItem(self.tr("scanned in the simulated cell"), "scan")
        self._source.addItem(self.tr("known by its mesh"), "mesh")
        self._source.setToolTip(
            self.tr("Scanned, errors of the reconstruction count; it takes some seconds for each")
        )
        self._seeds = self._number("fit_seeds", _SEEDS, 20, self.tr("Each object is judged with each seed"))
        tip = self.tr("Sets of values to try; the first is where it starts")
        self._trials = self._number("fit_trials", _TRIALS, 1000, tip)
        form = QFormLayout()
        form.setHorizontalSpacing(2 * GRID_PX)
        form.setVerticalSpacing(GRID_PX)
        form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft)
        for title, widget in (
            (self.tr("Each object is"), self._source),
            (self.tr("Seeds"), self._seeds),
            (self.tr("Trials"), self._trials),
        ):
            widget.setAccessibleName(title)
            form.addRow(title, widget)
        return form

    def _number(self, name: str, value: int, most: int, tip: str) -> QSpinBox:
        box = QSpinBox()
        box.setObjectName(name)
        box.setRange(1, most)
        box.setValue(value)
        box.setToolTip(tip)
        box.setFixedWidth(12 * GRID_PX)
        return box

    @property
    def wishes(self) -> FitWishes:
        """What is chosen now."""
        source: Literal["mesh", "scan"] = "scan" if self._source.currentData() == "scan" else "mesh"
        fitted = tuple(one for one, box in self._boxes.items() if box.isChecked())
        return FitWishes(fitted, self._all.isChecked(), source, self._seeds.value(), self._trials.value())

    def show_measure(self, measure: Measure) -> None:
        """Say what judges."""
        said = self.tr(
            "Judged by {measure}. Its threshold needs no search: it goes where it tells the labels apart "
            "best."
        )
        self._measure_note.setText(said.format(measure=measure_noun(measure)))

    def show_objects(self, objects: tuple[LabelledObject, ...], problem: str, can_choose: bool) -> None:
        """Say what is fitted to.

        Args:
            objects: that are chosen.
            problem: why nothing can be fitted to them; empty if it can.
            can_choose: whether some, but not all, are marked for calibration.
        """
        self._all.setVisible(can_choose)
        n_containers = sum(one.label == "container" for one in objects)
        said = self.tr("{n} objects; containers: {containers}, others: {others}.")
        counted = said.format(n=len(objects), containers=n_containers, others=len(objects) - n_containers)
        self._objects_note.setText(problem or counted)
        self._objects_note.setToolTip(", ".join(one.name for one in objects))
