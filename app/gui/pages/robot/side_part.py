"""The side of the robot page: one step at a time, with its one button."""

from __future__ import annotations

from PySide6.QtWidgets import QFrame, QPushButton

from app.gui.pages.page import SidePanel
from app.gui.pages.robot.check_panel import CheckPanel
from app.gui.pages.robot.live_panel import LivePanel
from app.gui.pages.robot.outcome_panel import OutcomePanel
from app.gui.pages.robot.panel import Panel
from app.gui.pages.robot.recovery_panel import RecoveryPanel
from app.gui.pages.robot.runs_part import RunsPart
from app.gui.pages.robot.start_panel import StartPanel
from app.gui.pages.robot.state_part import StatePart
from app.gui.pages.robot.step_bar import StepBar
from app.gui.pages.robot.steps import Step
from app.gui.views.hold_button import HoldButton


class RobotSide(SidePanel):
    """The row of steps, the panel of the current one, the arm's state, and the runs.

    Attributes:
        steps: the row of steps.
        start: while something is missing, and before connecting and planning.
        check: with a plan.
        live: while the arm moves.
        recovery: after a stop.
        outcome: after a pour.
        state: of the connected arm.
        runs: of the session.
        hold_to_pour: the only way to a pour.
        hold_to_back_off: the only way back.
        again: plans anew instead of what the step asks for.
    """

    def __init__(self) -> None:
        super().__init__("")
        self.steps = StepBar()
        self.start = StartPanel()
        self.check = CheckPanel()
        self.live = LivePanel()
        self.recovery = RecoveryPanel()
        self.outcome = OutcomePanel()
        self.state = StatePart()
        self.runs = RunsPart()
        self.hold_to_pour = HoldButton(
            self.tr("Hold to pour"), self.tr("Released too early: nothing moved"), 1.5
        )
        self.hold_to_pour.setObjectName("hold_to_pour")
        self.hold_to_back_off = HoldButton(
            self.tr("Hold to back off"), self.tr("Released too early: nothing moved"), 1.5
        )
        self.hold_to_back_off.setObjectName("hold_to_back_off")
        self.again = QPushButton()
        self.again.setObjectName("again")
        self.add_button(self.again)
        for held in (self.hold_to_pour, self.hold_to_back_off):
            self._buttons.addWidget(held)
        self._panels: tuple[Panel, ...] = (self.start, self.check, self.live, self.recovery, self.outcome)
        self._fill()

    def _fill(self) -> None:
        self.body.addWidget(self.steps)
        for panel in self._panels:
            self.body.addWidget(panel)
        line = QFrame()
        line.setProperty("role", "line")
        self.body.addWidget(line)
        self.body.addWidget(self.state)
        self.body.addWidget(self.runs)
        self.body.addStretch(1)
        self.runs.hide()

    def show_step(self, step: Step) -> None:
        """Show the panel of a step, and the button that is held in it; the primary one goes by its text."""
        self.steps.set_current(step.number)
        shown = {Step.CHECK: self.check, Step.OUTCOME: self.outcome}.get(step, self.start)
        if step.is_moving:
            shown = self.live
        elif step.is_recovery:
            shown = self.recovery
        for panel in self._panels:
            panel.setVisible(panel is shown)
        self.hold_to_pour.setVisible(step is Step.CHECK)
        self.hold_to_back_off.setVisible(step is Step.BACK)
        self.again.setVisible(step in (Step.CHECK, Step.OUTCOME))
