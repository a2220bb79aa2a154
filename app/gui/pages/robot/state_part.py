"""How the connected arm is, and its gripper by hand."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QWidget

from app.gui.pages.fact_grid import Fact
from app.gui.pages.robot.panel import Panel
from app.gui.pages.robot.words import state_facts
from app.gui.theme import GRID_PX
from app.gui.views.hold_button import HoldButton
from app.gui.views.labels import say, text_label
from app.gui.views.painting import tabular
from app.jobs.arm_news import ArmConnected, ArmStatus


class StatePart(Panel):
    """Facts of the arm; below them, folded away, the gripper.

    Attributes:
        leave_wanted: somebody wants to disconnect.
        gripper_wanted: the gripper's button was held: whether it is to close.
    """

    leave_wanted = Signal()
    gripper_wanted = Signal(bool)

    def __init__(self) -> None:
        super().__init__("state_part", "")
        self.heading.setProperty("role", "heading")
        self._is_closed = False
        self._facts = _FactPairs()
        self._silence = text_label("arm_silence", "attention")
        self._leave = self._link(
            "disconnect", self.tr("Disconnect"), self.tr("Let the arm go; it stays as it is")
        )
        self._unfold = self._link(
            "gripper_by_hand",
            self.tr("Gripper by hand"),
            self.tr("Open or close the gripper of the standing arm"),
        )
        self._unfold.setCheckable(True)
        self._warning = text_label(
            "gripper_warning", "muted", self.tr("Keep your fingers out. What it holds falls when it opens.")
        )
        self._hold = HoldButton("", hold_s=1.0)
        self._hold.setObjectName("hold_gripper")
        self._leave.clicked.connect(self.leave_wanted)
        self._unfold.toggled.connect(lambda _: self._fold())
        self._hold.confirmed.connect(lambda: self.gripper_wanted.emit(not self._is_closed))
        links = QHBoxLayout()
        links.setSpacing(3 * GRID_PX)
        links.addWidget(self._unfold)
        links.addWidget(self._leave)
        links.addStretch(1)
        for one in (self._silence, self._facts):
            self.column.addWidget(one)
        self.column.addLayout(links)
        self.column.addWidget(self._warning)
        self.column.addWidget(self._hold)
        self._is_gripper_free = False
        self._fold()

    def show_state(
        self, arm: ArmConnected, status: ArmStatus | None, stop_line: bool, is_silent: bool
    ) -> None:
        """Show how the arm is."""
        self.heading.setText(arm.name)
        silence = self.tr(
            "The process that moves the arm says nothing: what is shown is old. STOP has its own way."
        )
        say(self._silence, silence if is_silent else "")
        if status is None:
            return
        self._facts.set_facts(state_facts(status, stop_line))
        self._is_closed = bool(status.is_gripper_closed)
        words = (
            self.tr("Hold to open the gripper") if self._is_closed else self.tr("Hold to close the gripper")
        )
        if words != self._hold.text():
            self._hold.setText(words)
            self._hold.setAccessibleName(words)
            self._hold.updateGeometry()

    def let_do(self, may_leave: bool, may_grip: bool) -> None:
        """Allow to disconnect, and to use the gripper: with the arm at rest and no cup on its way."""
        self._leave.setVisible(may_leave)
        if may_grip != self._is_gripper_free:
            self._is_gripper_free = may_grip
            self._fold()

    def unfold(self) -> None:
        """Show the gripper's button: it has to be opened."""
        self._unfold.setChecked(True)

    def _fold(self) -> None:
        self._unfold.setVisible(self._is_gripper_free)
        is_open = self._is_gripper_free and self._unfold.isChecked()
        self._warning.setVisible(is_open)
        self._hold.setVisible(is_open)

    def _link(self, name: str, text: str, tip: str) -> QPushButton:
        link = QPushButton(text)
        link.setObjectName(name)
        link.setProperty("role", "link")
        link.setToolTip(tip)
        return link


class _FactPairs(QWidget):
    """Two facts a row; the labels stay, only their words change."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("arm_facts")
        self._labels: list[tuple[QLabel, QLabel]] = []
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(GRID_PX)
        self._grid.setVerticalSpacing(GRID_PX // 2)
        self._grid.setColumnStretch(1, 1)
        self._grid.setColumnStretch(3, 1)

    def set_facts(self, facts: Sequence[Fact]) -> None:
        """Show facts, always as many."""
        while len(self._labels) < len(facts):
            self._add_pair()
        for (title, value), fact in zip(self._labels, facts, strict=True):
            title.setText(fact.title)
            value.setText(fact.value)
            for one in (title, value):
                one.setToolTip(fact.tooltip)

    def _add_pair(self) -> None:
        row, side = divmod(len(self._labels), 2)
        title, value = QLabel(), QLabel()
        title.setProperty("role", "muted")
        value.setFont(tabular(self.font()))
        self._grid.addWidget(title, row, 2 * side)
        self._grid.addWidget(value, row, 2 * side + 1)
        self._labels.append((title, value))
