"""After a pour: how many candies were spilled, by physics or by counting."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QLineEdit, QPushButton

from app.gui.pages.robot.panel import Panel
from app.gui.theme import GRID_PX
from app.gui.views.labels import say, text_label
from app.gui.views.painting import tabular
from core.session.pour_runs import Outcome, PourRun

_BIG_PX = 7 * GRID_PX
_NUMBER_POINTS = 30


class OutcomePanel(Panel):
    """A number with a big minus and a big plus, to be used in gloves.

    Attributes:
        edited: something was entered.
    """

    edited = Signal()

    def __init__(self) -> None:
        super().__init__("outcome_panel", self.tr("What became of the candies?"))
        self._n_candies = 0
        self._spilled: int | None = None
        self._before: Outcome | None = None
        self._how = text_label("outcome_how", "muted")
        self._question = text_label("outcome_question", "heading", self.tr("Spilled candies"))
        self._number = QLabel()
        self._number.setObjectName("spilled")
        self._number.setFont(tabular(self.font(), _NUMBER_POINTS, bold=True))
        self._of = text_label("outcome_of", "muted")
        self._less = self._big_button("spilled_less", "\N{MINUS SIGN}", self.tr("One less was spilled"), -1)
        self._more = self._big_button("spilled_more", "+", self.tr("One more was spilled"), +1)
        self._not_counted = QCheckBox(self.tr("Not counted"))
        self._not_counted.setObjectName("not_counted")
        self._not_counted.toggled.connect(self._look)
        self._remarks = QLineEdit()
        self._remarks.setObjectName("remarks")
        self._remarks.setAccessibleName(self.tr("Remarks"))
        self._remarks.setPlaceholderText(self.tr("Remarks, such as: one rolled off"))
        self._remarks.textEdited.connect(lambda _: self.edited.emit())
        self._failure = text_label("outcome_failure", "failed")
        self._build()

    def _build(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._less)
        row.addWidget(self._number)
        row.addWidget(self._more)
        row.addWidget(self._of)
        row.addStretch(1)
        self.column.addWidget(self._how)
        self.column.addWidget(self._question)
        self.column.addLayout(row)
        for one in (self._not_counted, self._remarks, self._failure):
            self.column.addWidget(one)

    @property
    def is_complete(self) -> bool:
        """Whether there is something to be saved."""
        return self._spilled is not None or self._not_counted.isChecked()

    @property
    def outcome(self) -> Outcome:
        """What was entered; as physics told it, if nobody corrected it."""
        spilled = None if self._not_counted.isChecked() else self._spilled
        remarks = self._remarks.text().strip()
        before = self._before
        if before is not None and (before.n_spilled, before.remarks) == (spilled, remarks):
            return before
        return Outcome(self._n_candies, spilled, remarks, is_simulated=False, facts={})

    def show_counting(self) -> None:
        """Physics is at it."""
        self.show_run(None, 0, "")
        say(self._how, self.tr("Physics counts the candies: the cup as it was driven, over the true object."))
        self._enable(False)

    def show_run(self, run: PourRun | None, n_candies: int, failure: str) -> None:
        """Ask for a run's outcome, beginning with what is known of it."""
        before = run.outcome if run is not None else None
        self._before, self._n_candies = before, n_candies
        self._spilled = before.n_spilled if before is not None else None
        self._not_counted.setChecked(before is not None and before.n_spilled is None)
        self._remarks.setText(before.remarks if before is not None else "")
        self._enable(True)
        say(self._how, self._origin(before))
        say(self._of, self.tr("of {n}").format(n=n_candies) if n_candies else "")
        say(self._failure, failure)
        self._look()

    def _origin(self, before: Outcome | None) -> str:
        if before is None:
            return self.tr("Count the candies beside the object. None spilled? Press {minus} once.").format(
                minus="\N{MINUS SIGN}"
            )
        if before.is_simulated:
            return self.tr(
                "SIMULATED: physics of its own counted them over the true object. Correct it if need be."
            )
        return self.tr("As it was entered.")

    def _count(self, change: int) -> None:
        before = 0 if self._spilled is None else self._spilled + change
        if self._spilled is None and change > 0:
            before = 1
        highest = self._n_candies or before
        self._spilled = min(max(before, 0), highest)
        self._look()

    def _look(self) -> None:
        is_counted = not self._not_counted.isChecked()
        self._less.setEnabled(is_counted and self._spilled != 0)
        self._more.setEnabled(is_counted and (self._spilled is None or self._spilled != self._n_candies))
        shown = "\N{EN DASH}" if self._spilled is None or not is_counted else str(self._spilled)
        self._number.setText(shown)
        self._number.setAccessibleName(self.tr("{n} candies were spilled").format(n=shown))
        self.edited.emit()

    def _enable(self, is_enabled: bool) -> None:
        for one in (self._less, self._more, self._not_counted, self._remarks):
            one.setEnabled(is_enabled)

    def _big_button(self, name: str, text: str, tip: str, change: int) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(tip)
        button.setToolTip(tip)
        button.setFixedSize(_BIG_PX, _BIG_PX)
        button.setFont(tabular(self.font(), 20, bold=True))
        button.setAutoRepeat(True)
        button.clicked.connect(lambda: self._count(change))
        return button
