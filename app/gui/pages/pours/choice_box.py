"""The pour that will be made, why this one, and choosing another with a reason."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from app.gui.pages.pours.results import ShownPours
from app.gui.pages.pours.words import chosen_sentence, why_sentences
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, rule, say, text_label


class ChoiceBox(QWidget):
    """The choice and its reasons.

    Attributes:
        stale: says when the pours are not what the parameters would give now.
        chosen: the reason for which the selected pour shall be made instead.
        withdrawn: the program shall choose again.
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
        self.stale = StaleNote(("reconstruction", "collision", "pouring"))
        self._why = text_label("chosen_why")
        self._form = QWidget()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        for widget in (self._verdict, self.stale, self._why, self._form):
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
                self.tr("something stands on that side"),
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
        say(self._why, remark if pours is None else "\n\n".join(why_sentences(pours)))
        self._form.setVisible(pours is not None and pours.grid is not None)
        self._update()

    def set_selection(self, selection: tuple[int, int] | None, is_open: bool) -> None:
        """Tell which pour could be chosen, and whether it may be now."""
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
            return self.tr("The reason is kept with the session, in the run's log and in the report.")
        return ""

    def _choose(self) -> None:
        if self._choose_button.isEnabled():
            self.chosen.emit(self._reason.currentText().strip())
