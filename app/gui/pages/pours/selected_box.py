"""What is known of the selected pour, and whether the arm can make it."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton, QSizePolicy, QVBoxLayout, QWidget

from app.gui.pages.pours.results import ShownPours
from app.gui.pages.pours.words import feasibility_sentence, selected_sentence
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, say, text_label


class SelectedBox(QWidget):
    """Facts of one pour.

    Attributes:
        check_wanted: somebody wants to know which pours the arm can make.
    """

    check_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("selected_pour")
        self._heading = heading(self.tr("Selected pour"))
        self._facts = text_label("selected_facts")
        self._arm = text_label("selected_arm")
        self._check = QPushButton(self.tr("Check with the arm"))
        self._check.setObjectName("check_with_arm")
        self._check.setAccessibleName(self.tr("Check all pours with the arm"))
        self._check.setToolTip(self.tr("Plan all pours with the cell's arm; nothing moves"))
        self._check.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        self._check.clicked.connect(lambda: self.check_wanted.emit())
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, 2 * GRID_PX)
        column.setSpacing(GRID_PX // 2)
        for widget in (self._heading, self._facts, self._arm, self._check):
            column.addWidget(widget)

    def show_pour(self, pours: ShownPours | None, selection: tuple[int, int] | None, can_check: bool) -> None:
        """Show a pour; none: nothing to select."""
        self.setVisible(pours is not None and pours.grid is not None)
        if pours is None or pours.grid is None:
            return
        if selection is None:
            say(self._facts, self.tr("Click a field of the map, or a pivot in the 3D view."))
            say(self._arm, "")
        else:
            say(self._facts, selected_sentence(pours, *selection))
            say(self._arm, feasibility_sentence(pours, *selection))
        found = None if selection is None else pours.feasibility(*selection)
        role = "attention" if found is not None and not found.is_feasible else ""
        if self._arm.property("role") != role:
            self._arm.setProperty("role", role)
            self._arm.style().polish(self._arm)
        self._check.setVisible(pours.stands_in_cell and pours.motions is None)
        self._check.setEnabled(can_check)
