"""Before there is a plan: what is missing, connecting, and planning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton

from app.gui.pages.robot.panel import Panel
from app.gui.views.labels import say, text_label
from core.session.cups import Cup

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings


class StartPanel(Panel):
    """Says what the primary button will do, and what was in the way the last time.

    Attributes:
        emptied: somebody took out of the object what the cups before had poured.
    """

    emptied = Signal()

    def __init__(self) -> None:
        super().__init__("start_panel", "")
        self._text = text_label("start_text")
        self._note = text_label("start_note", "attention")
        self._failure = text_label("start_failure", "failed")
        for one in (self._note, self._failure, self._text):
            self.column.addWidget(one)
        self._empty = QPushButton(self.tr("The object was emptied: begin with cup 1"))
        self._empty.setObjectName("object_emptied")
        self._empty.clicked.connect(self.emptied)
        self.column.addWidget(self._empty)

    def show_missing(self, heading: str, text: str) -> None:
        """Say why there is no pour to make."""
        self._show(heading, text)

    def show_connect(self, cell: CellSettings | None, farewell: str, failure: str) -> None:
        """Say what connecting does."""
        if cell is None:
            self._show(self.tr("Connect the arm"), self.tr("The cell's file is being read."))
            return
        if cell.robot.kind == "ur5":
            text = self.tr(
                "{name}: a real {model} at {address}. Connecting moves nothing; it replaces the program that "
                "runs on the controller, and sets tool frame, payload and the tool's voltage there."
            ).format(name=cell.name, model=cell.robot.model, address=cell.robot.address)
        else:
            text = self.tr(
                "{name}: a simulated {model}, {n:g} times as fast as a real one. The same driver talks to it "
                "as to a real arm; nothing real moves."
            ).format(name=cell.name, model=cell.robot.model, n=cell.simulation.speed_up)
        self._show(self.tr("Connect the arm"), text, farewell, failure)

    def show_plan(self, is_gripper_closed: bool, has_backed_off: bool, failure: str, cup: Cup) -> None:
        """Say what planning does, for which of several cups, and what has to be seen to before."""
        note = ""
        if is_gripper_closed:
            note = self.tr(
                "The gripper is closed: a cup may be in the hand. Hold the cup, open the gripper below, and "
                "put the cup to its station."
            )
        elif has_backed_off:
            note = self.tr(
                "The arm is home again. See that the cup stands at its station and is filled, then plan anew."
            )
        text = self.tr(
            "The way is planned from where the arm stands now, checked sample by sample, and shown before "
            "anything moves."
        )
        if cup.number > 1:
            text += " " + self.tr("Next comes {cup}; those before it lie in the object.").format(
                cup=cup.words
            )
        self._show(self.tr("Plan the pour"), text, note, failure)
        self._empty.setVisible(cup.number > 1)

    def _show(self, heading: str, text: str, note: str = "", failure: str = "") -> None:
        self.heading.setText(heading)
        self._empty.hide()
        say(self._text, text)
        say(self._note, note)
        say(self._failure, failure)
