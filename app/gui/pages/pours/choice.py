"""The pour that will be made, the one that is selected on the map, and what is said of both."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from app.gui.pages.pours.results import ShownPours
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, rule, say, text_label
from core.imagination.amount.result import amount_text
from core.imagination.results import PourGrid
from core.pipeline.session_view import IMAGINED
from core.report import (
    motion_sentence,
    operator_sentence,
    risk_sentence,
    tries_sentence,
    verdict_sentence,
)
from core.report.sentences import NO_POURS, direction_text, duration_text, ratio_text

MM = 1000.0
SURE_ENOUGH = 0.8
"""Below this chance that nothing is spilled (lower 95 % bound), the heading carries a warning."""


class ChoiceBox(QWidget):
    """The choice and its reasons.

    Attributes:
        stale: says when the pours are not what the parameters would give now.
        chosen: the reason for making the selected pour instead.
        withdrawn: let the program choose again.
    """

    chosen = Signal(str)
    withdrawn = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("choice")
        self._pours: ShownPours | None = None
        self._selection: tuple[int, int] | None = None
        self._is_open = False
        self._verdict = text_label("chosen_pour", "verdict")
        self._warning = text_label("pour_warning", "attention")
        self.stale = StaleNote(("reconstruction", "collision", *IMAGINED))
        self._why = text_label("chosen_why")
        self._form = QWidget()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        for widget in (self._verdict, self._warning, self.stale, self._why, self._form):
            column.addWidget(widget)
        self._build_form()

    def _build_form(self) -> None:
        self._reason = QComboBox()
        self._reason.setObjectName("reason")
        self._reason.setAccessibleName(self.tr("Reason for choosing another pour"))
        self._reason.setEditable(True)
        self._reason.addItems(
            [
                self.tr("the handle is in the way"),
                self.tr("something is in the way on that side"),
                self.tr("this side is easier to watch"),
                self.tr("tried before, and it spilled less"),
            ]
        )
        self._reason.setCurrentIndex(-1)
        self._reason.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._reason.setMinimumContentsLength(12)
        editor = self._reason.lineEdit()
        assert editor is not None, "it is editable"
        editor.setPlaceholderText(self.tr("the reason, in a few words"))
        editor.setMaxLength(200)
        editor.returnPressed.connect(self._choose)
        self._reason.editTextChanged.connect(lambda _text: self._update())
        self._choose_button = QPushButton(self.tr("Choose this pour"))
        self._choose_button.setObjectName("choose_pour")
        self._choose_button.clicked.connect(self._choose)
        self._withdraw = QPushButton(self.tr("Withdraw"))
        self._withdraw.setObjectName("withdraw_choice")
        self._withdraw.setToolTip(self.tr("Let the program choose again"))
        self._withdraw.clicked.connect(lambda: self.withdrawn.emit())
        self._hint = text_label("choose_hint", "muted")
        buttons = QHBoxLayout()
        buttons.setSpacing(GRID_PX)
        buttons.addWidget(self._choose_button)
        buttons.addWidget(self._withdraw)
        buttons.addStretch(1)
        column = QVBoxLayout(self._form)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(rule())
        column.addWidget(heading(self.tr("Choose another")))
        column.addWidget(self._reason)
        column.addLayout(buttons)
        column.addWidget(self._hint)

    def show_pours(self, pours: ShownPours | None, remark: str) -> None:
        """Show a choice, or none; `remark` says why there is none."""
        self._pours = pours
        say(self._verdict, self.tr("No pours yet.") if pours is None else chosen_sentence(pours))
        say(self._warning, "" if pours is None else risk_warning(pours))
        say(self._why, remark if pours is None else "\n\n".join(why_sentences(pours)))
        self._form.setVisible(pours is not None and pours.grid is not None)
        self._update()

    def set_selection(self, selection: tuple[int, int] | None, is_open: bool) -> None:
        """Say which pour could be chosen, and whether it may be now."""
        self._selection, self._is_open = selection, is_open
        self._update()

    def clear_reason(self) -> None:
        """Forget what was typed."""
        self._reason.setCurrentIndex(-1)
        self._reason.clearEditText()

    def _update(self) -> None:
        pours = self._pours
        if pours is None or pours.grid is None:
            return
        obstacle = self._obstacle(pours)
        has_reason = bool(self._reason.currentText().strip())
        self._choose_button.setEnabled(self._is_open and not obstacle and has_reason)
        is_withdrawable = pours.operator is not None or bool(pours.problem)
        self._withdraw.setVisible(is_withdrawable)
        self._withdraw.setEnabled(self._is_open)
        say(self._hint, obstacle)
        self._hint.setToolTip(obstacle)

    def _obstacle(self, pours: ShownPours) -> str:
        """Why the selected pour cannot be chosen."""
        if self._selection is None:
            return self.tr("Select a pour on the map first.")
        if self._selection == pours.chosen:
            return self.tr("Select another pour on the map; the selected one is chosen already.")
        found = pours.feasibility(*self._selection)
        if found is not None and not found.is_feasible:
            return self.tr("The arm cannot make the selected pour.")
        if not self._reason.currentText().strip():
            return self.tr("The reason is recorded in the session, in the run's log and in the report.")
        return ""

    def _choose(self) -> None:
        if self._choose_button.isEnabled():
            self.chosen.emit(self._reason.currentText().strip())


class SelectedBox(QWidget):
    """Facts of one pour.

    Attributes:
        check_wanted: which pours can the arm make?
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
        self._check.setVisible(pours.is_in_cell and pours.motions is None)
        self._check.setEnabled(can_check)


def chosen_sentence(pours: ShownPours) -> str:
    """Say which pour will be made, how good it is, and whether the arm can make it."""
    grid, chosen = pours.grid, pours.chosen
    if grid is None and pours.containability.is_open_container:
        return _tr("No pours yet.")
    if grid is None:
        return NO_POURS
    if chosen is None:
        return _tr("None chosen: the arm cannot make any of the pours.")
    return _tr("Chosen: {pour}, {arm}.").format(
        pour=_pour_words(grid, *chosen), arm=_arm_words(pours, *chosen)
    )


def risk_warning(pours: ShownPours) -> str:
    """Say that the chosen pour is not sure enough to spill nothing; empty if it is, or nobody knows."""
    if pours.chosen is None or pours.risk is None:
        return ""
    clean = float(pours.risk.clean_at_least[pours.chosen])
    said = _tr("\N{WARNING SIGN} A clean pour is only {percent:.0f}\N{NO-BREAK SPACE}% sure.")
    return "" if clean >= SURE_ENOUGH else said.format(percent=100 * clean)


def why_sentences(pours: ShownPours) -> list[str]:
    """Say why this one: a person, the arm, the trials, or the paper's rule with its numbers."""
    grid = pours.grid
    if grid is None:
        return [_no_pours(pours)]
    said = [] if pours.amount is None else [amount_text(pours.amount)]
    if pours.operator is not None:
        said.append(operator_sentence(pours.operator, grid, pours.program_choice))
    elif pours.is_free_choice and pours.choice is not None and pours.paper_choice is not None:
        if pours.risk is not None:
            said.append(risk_sentence(grid, pours.risk, pours.choice, pours.paper_choice))
        else:
            said.append(_rule(grid, pours.paper_choice.i, pours.paper_choice.j))
    if pours.motions is not None and pours.operator is None:
        said.append(motion_sentence(pours.motions, grid))
    if pours.problem:
        said.append(pours.problem)
    return said


def selected_sentence(pours: ShownPours, i: int, j: int) -> str:
    """Say where a pour is from, and how much of it lands inside."""
    assert pours.grid is not None, "there is a pour"
    said = _tr("{pour} of the {n} candies land inside.").format(
        pour=_pour_words(pours.grid, i, j).capitalize(), n=pours.grid.n_pour
    )
    return said if pours.risk is None else f"{said} {tries_sentence(pours.risk, i, j)}"


def feasibility_sentence(pours: ShownPours, i: int, j: int) -> str:
    """Say whether the arm can make a pour, or why not, or why that is not known."""
    if not pours.is_in_cell:
        return _tr(
            "An imported mesh is not in the cell, so no arm can pour into it. Scan the object to pour."
        )
    found = pours.feasibility(i, j)
    if found is None:
        return _tr("Not checked with this cell's arm since the pours were imagined.")
    if not found.is_feasible:
        return _tr("The arm cannot make it: {reason}").format(reason=found.reason)
    return _tr("The arm can make it in {time}, with {mm:.0f} mm clearance.").format(
        time=duration_text(found.duration_s), mm=MM * found.clearance_m
    )


def _pour_words(grid: PourGrid, i: int, j: int) -> str:
    return _tr("from {deg}, {mm:.0f} mm out: {ratio}\N{NO-BREAK SPACE}%").format(
        deg=direction_text(float(grid.theta_rad[i])),
        mm=MM * grid.indent_m[j],
        ratio=ratio_text(grid, i, j).replace(" ", "\N{NO-BREAK SPACE}"),
    )


def _arm_words(pours: ShownPours, i: int, j: int) -> str:
    if not pours.is_in_cell:
        return _tr("imagined only")
    found = pours.feasibility(i, j)
    if found is None:
        return _tr("not yet checked with the arm")
    if not found.is_feasible:
        return _tr("out of the arm's reach")
    return _tr("reachable, {mm:.0f} mm clearance").format(mm=MM * found.clearance_m)


def _rule(grid: PourGrid, i: int, j: int) -> str:
    """The argmax rule of Sec. III-B with the numbers it was decided by."""
    sums = grid.n_in.sum(axis=(1, 2))
    n = len(sums)
    mean = _tr("{mean:.1f} % on average over its distances").format(mean=100 * grid.p[i].mean())
    tied = int((sums == sums[i]).sum())
    if n == 1:
        first = _tr("Only the direction {direction} was imagined: {mean}.")
    elif tied > 1:
        first = _tr(
            "{tied} directions do equally well ({mean}); the one nearest the footprint's long axis is "
            "{direction}."
        )
    else:
        first = _tr("Direction {direction} is the best of {n}: {mean}.")
    second = _tr("Of its distances, {mm:.0f} mm is the best, or the smallest of equals.")
    direction = direction_text(float(grid.theta_rad[i]))
    mm = MM * grid.indent_m[j]
    return f"{first} {second}".format(tied=tied, n=n, mean=mean, direction=direction, mm=mm)


def _no_pours(pours: ShownPours) -> str:
    found = pours.containability
    if found.is_open_container:
        return _tr("The run ended before the pours were imagined; imagine again to continue.")
    only = _tr("Pours are imagined for open containers only.")
    return f"{only} {verdict_sentence(found)}"


def _tr(text: str) -> str:
    return QCoreApplication.translate("Pours", text)
