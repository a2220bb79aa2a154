"""The side's panels after a motion: what became of the candies, the runs so far, the return after a stop."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QLineEdit, QPushButton, QWidget

from app.gui.pages.robot.panels import Panel
from app.gui.pages.robot.step_bar import Disc, DiscState, state_of
from app.gui.pages.robot.steps import Step
from app.gui.theme import GRID_PX
from app.gui.views.fact_table import Column, FactTable, Row
from app.gui.views.labels import say, text_label
from app.gui.views.painting import tabular
from core.session.pour_runs import Outcome, PourRun

_BIG_PX = 7 * GRID_PX
_NUMBER_POINTS, _SIGN_POINTS = 30, 20
_MINUS, _EN_DASH = "\N{MINUS SIGN}", "\N{EN DASH}"


class OutcomePanel(Panel):
    """A number with a big minus and a big plus, to be used in gloves; above it what is known of the pour.

    Attributes:
        edited: something was entered.
        report_wanted: somebody wants to read the report.
        object_wanted: somebody wants to go on with another object.
    """

    edited = Signal()
    report_wanted = Signal()
    object_wanted = Signal()

    def __init__(self) -> None:
        super().__init__("outcome_panel", self.tr("What became of the candies?"))
        self._name = self.tr("object")
        self._n_candies = 0
        self._spilled: int | None = None
        self._before: Outcome | None = None
        self._origin = text_label("outcome_how", "muted")
        self._number = QLabel()
        self._number.setObjectName("spilled")
        self._number.setFont(tabular(self.font(), _NUMBER_POINTS, bold=True))
        self._of = text_label("outcome_of", "muted")
        self._less = self._big_button("spilled_less", _MINUS, self.tr("One spilled candy less"), -1)
        self._more = self._big_button("spilled_more", "+", self.tr("One spilled candy more"), +1)
        self._not_counted = QCheckBox(self.tr("Not counted"))
        self._not_counted.setObjectName("not_counted")
        self._not_counted.toggled.connect(self._show_number)
        self._remarks = QLineEdit()
        self._remarks.setObjectName("remarks")
        self._remarks.setAccessibleName(self.tr("Remarks"))
        self._remarks.setPlaceholderText(self.tr("Remarks, such as: one rolled off"))
        self._remarks.textEdited.connect(lambda _: self.edited.emit())
        self._failure = text_label("outcome_failure", "failed")
        self._arrange()

    def _arrange(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(2 * GRID_PX)
        for widget in (self._less, self._number, self._more, self._of):
            row.addWidget(widget)
        row.addStretch(1)
        self.column.addWidget(self._origin)
        self.column.addWidget(text_label("outcome_question", "heading", self.tr("Spilled candies")))
        self.column.addLayout(row)
        self.column.addWidget(self._not_counted)
        self.column.addWidget(self._remarks)
        self.column.addWidget(self._failure)
        links = QHBoxLayout()
        links.setSpacing(GRID_PX)
        for name, text, signal in (
            ("outcome_report", self.tr("Report"), self.report_wanted),
            ("outcome_new", self.tr("New object…"), self.object_wanted),
        ):
            button = QPushButton(text)
            button.setObjectName(name)
            button.clicked.connect(signal)
            links.addWidget(button)
        links.addStretch(1)
        self.column.addLayout(links)

    def call_object(self, name: str) -> None:
        """Call the object by its session's name, if that is one plain word."""
        self._name = name.lower() if name.isalpha() else self.tr("object")

    @property
    def is_complete(self) -> bool:
        """Whether there is something to be saved."""
        return self._spilled is not None or self._not_counted.isChecked()

    @property
    def outcome(self) -> Outcome:
        """What was entered; as physics counted it, if nobody corrected it."""
        spilled = None if self._not_counted.isChecked() else self._spilled
        remarks = self._remarks.text().strip()
        before = self._before
        if before is not None and (before.n_spilled, before.remarks) == (spilled, remarks):
            return before
        return Outcome(self._n_candies, spilled, remarks, is_simulated=False, facts={})

    def show_counting(self) -> None:
        """Physics is still counting."""
        self.show_run(None, 0, "")
        said = self.tr("Physics is counting the candies: the cup as it was driven, over the true object.")
        say(self._origin, said)
        self._set_enabled(False)

    def show_run(self, run: PourRun | None, n_candies: int, failure: str) -> None:
        """Ask for a run's outcome, beginning with what is known of it."""
        before = run.outcome if run is not None else None
        self._before, self._n_candies = before, n_candies
        self._spilled = before.n_spilled if before is not None else None
        self._not_counted.setChecked(before is not None and before.n_spilled is None)
        self._remarks.setText(before.remarks if before is not None else "")
        self._set_enabled(True)
        say(self._origin, self._origin_text(before))
        say(self._of, self.tr("of {n}").format(n=n_candies) if n_candies else "")
        say(self._failure, failure)
        self._show_number()

    def _headline(self) -> str:
        """How many are in the object, once that is known; those left in the cup are not."""
        if self._spilled is None or self._not_counted.isChecked() or not self._n_candies:
            return self.tr("What became of the candies?")
        before = self._before
        n_in_cup = before.facts.get("n_in_cup", 0) if before is not None and before.is_simulated else 0
        n_in = self._n_candies - self._spilled - n_in_cup
        return self.tr("{n} of {all} in the {name}").format(n=n_in, all=self._n_candies, name=self._name)

    def _origin_text(self, before: Outcome | None) -> str:
        if before is None:
            said = self.tr("Count the candies beside the object. None spilled? Press {minus} once.")
            return said.format(minus=_MINUS)
        if before.is_simulated:
            return self.tr(
                "SIMULATED: counted by an independent simulation over the true object. Correct it if need be."
            )
        return self.tr("As it was entered.")

    def _count(self, change: int) -> None:
        n = max((self._spilled or 0) + change, 0)
        self._spilled = min(n, self._n_candies) if self._n_candies else n
        self._show_number()

    def _show_number(self) -> None:
        is_counted = not self._not_counted.isChecked()
        self._less.setEnabled(is_counted and self._spilled != 0)
        self._more.setEnabled(is_counted and (self._spilled is None or self._spilled != self._n_candies))
        shown = _EN_DASH if self._spilled is None or not is_counted else str(self._spilled)
        self._number.setText(shown)
        self.heading.setText(self._headline())
        self._number.setAccessibleName(self.tr("Spilled candies: {n}").format(n=shown))
        self.edited.emit()

    def _set_enabled(self, is_enabled: bool) -> None:
        for widget in (self._less, self._more, self._not_counted, self._remarks):
            widget.setEnabled(is_enabled)

    def _big_button(self, name: str, text: str, tip: str, change: int) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(tip)
        button.setToolTip(tip)
        button.setFixedSize(_BIG_PX, _BIG_PX)
        button.setFont(tabular(self.font(), _SIGN_POINTS, bold=True))
        button.setAutoRepeat(True)
        button.clicked.connect(lambda: self._count(change))
        return button


class RunsPart(Panel):
    """The pours of the session, the newest first; a click asks for a pour's outcome.

    Attributes:
        chosen: the folder of the run that was clicked.
    """

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__("runs_part", self.tr("Pours of this session"))
        self.heading.setProperty("role", "heading")
        self._runs: tuple[PourRun, ...] = ()
        self._is_allowed = True
        self.table = FactTable(
            (
                Column(self.tr("When"), tooltip=self.tr("When the run was confirmed"), align="left"),
                Column(self.tr("Spilled"), tooltip=self.tr("Candies beside the object")),
                Column(self.tr("Result"), align="left"),
            )
        )
        self.table.setObjectName("runs_table")
        self.table.setAccessibleName(self.tr("Pours of this session"))
        self.table.grow_with_rows()
        self.table.row_selected.connect(self._choose)
        self.column.addWidget(self.table)

    def show_runs(self, runs: Sequence[PourRun]) -> None:
        """Show other runs; nothing, if there are none."""
        self._runs = tuple(reversed(runs))
        self._show_or_hide()
        self.table.set_rows([self._row(run) for run in self._runs])

    def allow(self, is_allowed: bool) -> None:
        """Show the runs, or leave the room to what a step asks for."""
        self._is_allowed = is_allowed
        self._show_or_hide()

    def _show_or_hide(self) -> None:
        self.setVisible(self._is_allowed and bool(self._runs))

    def select(self, run: object) -> None:
        """Mark the run whose outcome is asked for; none: none of them."""
        found = [k for k, one in enumerate(self._runs) if one.folder == run]
        self.table.select_row(found[0] if found else None)

    def _row(self, run: PourRun) -> Row:
        needs_outcome = run.is_done and not run.is_back_off and run.outcome is None
        outcome = ""
        if run.is_done and not run.is_back_off:
            outcome = run.outcome.sentence if run.outcome else self.tr("Outcome not entered yet: click.")
        return Row(
            (_clock(run.begun), self._spilled(run), self._result(run)),
            tooltip="\n".join(filter(None, (run.sentence, run.note, outcome))),
            needs_attention=needs_outcome,
        )

    def _spilled(self, run: PourRun) -> str | None:
        if run.outcome is None or run.outcome.n_spilled is None:
            return None
        said = str(run.outcome.n_spilled)
        return self.tr("{n} (sim.)").format(n=said) if run.outcome.is_simulated else said

    def _result(self, run: PourRun) -> str:
        if run.is_done:
            return self.tr("backed off") if run.is_back_off else self.tr("poured")
        return self.tr("stopped on the return") if run.is_back_off else self.tr("stopped")

    def _choose(self, index: int) -> None:
        run = self._runs[index]
        if run.is_done and not run.is_back_off:
            self.chosen.emit(run.folder)


def _clock(time: str) -> str:
    return datetime.fromisoformat(time).astimezone().strftime("%d %b %H:%M") if time else "--"


class RecoveryPanel(Panel):
    """After a stop: what happened, and four steps back, one of which is the next.

    Attributes:
        by_hand: somebody has cleared everything by hand and wants to reconnect.
    """

    by_hand = Signal()

    def __init__(self) -> None:
        super().__init__("recovery_panel", self.tr("The arm was stopped"))
        self._what = text_label("recovery_what", "attention")
        self._failure = text_label("recovery_failure", "failed")
        texts = (
            self.tr("Find and fix what stopped it."),
            self.tr("Make the arm ready again. It does not move."),
            self.tr(
                "Let it back off slowly along its checked path: the cup upright to its station, then home."
            ),
            self.tr("Check that the cup stands on its station and is filled, then plan again."),
        )
        self._steps = tuple(_RecoveryStep(number, text) for number, text in enumerate(texts, start=1))
        self._by_hand = QPushButton(self.tr("Fixed by hand: reconnect"))
        self._by_hand.setObjectName("by_hand")
        self._by_hand.setProperty("role", "link")
        self._by_hand.setToolTip(
            self.tr("Discards the return: the cup is out of the hand, and the arm is at home")
        )
        self._by_hand.clicked.connect(self.by_hand)
        for widget in (self._what, *self._steps, self._failure, self._by_hand):
            self.column.addWidget(widget)

    def show_step(self, step: Step, what: str, must_back_off: bool, failure: str) -> None:
        """Show which step is the next.

        Args:
            step: one of the recovery.
            what: what happened or is in the way, in sentences.
            must_back_off: whether the arm was stopped on its path and has to come back.
            failure: why the last try failed; empty if it did not.
        """
        say(self._what, what)
        say(self._failure, failure)
        for recovery_step in self._steps:
            recovery_step.set_current(2 if step is Step.STOPPED else 3)
        self._steps[2].setVisible(must_back_off)
        self._steps[3].renumber(4 if must_back_off else 3)
        self._by_hand.setVisible(bool(failure))


class _RecoveryStep(QWidget):
    """A numbered sentence; done ones have a tick."""

    def __init__(self, number: int, text: str) -> None:
        super().__init__()
        self.setObjectName(f"guide_{number}")
        self._disc = Disc(number)
        self._text = text_label(f"guide_text_{number}", "", text)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX)
        row.addWidget(self._disc, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self._text, 1)

    def renumber(self, number: int) -> None:
        """Take another number."""
        self._disc.number = number
        self._disc.update()

    def set_current(self, current: int) -> None:
        """Know which step is the next."""
        number = self._disc.number
        # The first step is done by whoever presses the button of the second: both are the next one.
        state: DiscState = "next" if (number, current) == (1, 2) else state_of(number, current)
        self._disc.set_state(state)
        font = self._text.font()
        font.setBold(state == "next")
        self._text.setFont(font)
