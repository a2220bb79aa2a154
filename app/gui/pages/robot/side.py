"""The side of the robot page: one step at a time with its one button, the arm's state, and the runs."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Signal
from PySide6.QtWidgets import QHBoxLayout, QPushButton

from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.page import SidePanel
from app.gui.pages.robot.after_pour import OutcomePanel, RecoveryPanel, RunsPart
from app.gui.pages.robot.panels import CheckPanel, LivePanel, Panel, StartPanel
from app.gui.pages.robot.step_bar import StepBar
from app.gui.pages.robot.steps import Step
from app.gui.theme import GRID_PX
from app.gui.views.hold_button import HoldButton
from app.gui.views.labels import rule, say, text_label
from app.jobs.arm_events import ArmConnected, ArmStatus

_HOLD_S, _HOLD_GRIPPER_S = 1.5, 1.0


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
        early = self.tr("Released too early")
        self.hold_to_pour = HoldButton(self.tr("Hold to pour"), early, _HOLD_S)
        self.hold_to_pour.setObjectName("hold_to_pour")
        self.hold_to_back_off = HoldButton(self.tr("Hold to back off"), early, _HOLD_S)
        self.hold_to_back_off.setObjectName("hold_to_back_off")
        self.again = QPushButton()
        self.again.setObjectName("again")
        self.add_button(self.again)
        for button in (self.hold_to_pour, self.hold_to_back_off):
            self._buttons.addWidget(button)
        self._panels: tuple[Panel, ...] = (self.start, self.check, self.live, self.recovery, self.outcome)
        for widget in (self.steps, *self._panels, rule(), self.state, self.runs):
            self.body.addWidget(widget)
        self.body.addStretch(1)
        self.runs.hide()

    def show_step(self, step: Step) -> None:
        """Show the panel of a step, and the button that is held in it; the primary one goes by its text."""
        self.steps.set_current(step.number)
        shown: Panel = {Step.CHECK: self.check, Step.OUTCOME: self.outcome}.get(step, self.start)
        if step.is_moving:
            shown = self.live
        elif step.is_recovery:
            shown = self.recovery
        for panel in self._panels:
            panel.setVisible(panel is shown)
        self.hold_to_pour.setVisible(step is Step.CHECK)
        self.hold_to_back_off.setVisible(step is Step.CHECK_BACK_OFF)
        self.again.setVisible(step in (Step.CHECK, Step.OUTCOME))
        self.runs.allow(step is not Step.CHECK)  # all that is to be checked is seen without scrolling


class StatePart(Panel):
    """The state of the connected arm; below it, folded away, its gripper by hand.

    Attributes:
        disconnect_requested: somebody wants to disconnect.
        gripper_requested: the gripper's button was held: whether it is to close.
    """

    disconnect_requested = Signal()
    gripper_requested = Signal(bool)

    def __init__(self) -> None:
        super().__init__("state_part", "")
        self.heading.setProperty("role", "heading")
        self._is_closed = self._can_grip = False
        self._facts = FactGrid("arm_facts", per_row=2)
        self._silence = text_label("arm_silence", "attention")
        self._disconnect = self._link(
            "disconnect", self.tr("Disconnect"), self.tr("Release the arm; it stays where it is")
        )
        self._unfold = self._link(
            "gripper_by_hand",
            self.tr("Gripper by hand"),
            self.tr("Open or close the gripper while the arm is at rest"),
        )
        self._unfold.setCheckable(True)
        self._warning = text_label(
            "gripper_warning", "muted", self.tr("Keep your fingers out. What it holds falls when it opens.")
        )
        self._hold = HoldButton("", hold_s=_HOLD_GRIPPER_S)
        self._hold.setObjectName("hold_gripper")
        self._disconnect.clicked.connect(self.disconnect_requested)
        self._unfold.toggled.connect(lambda _: self._fold())
        self._hold.confirmed.connect(lambda: self.gripper_requested.emit(not self._is_closed))
        links = QHBoxLayout()
        links.setSpacing(3 * GRID_PX)
        links.addWidget(self._unfold)
        links.addWidget(self._disconnect)
        links.addStretch(1)
        self.column.addWidget(self._silence)
        self.column.addWidget(self._facts)
        self.column.addLayout(links)
        self.column.addWidget(self._warning)
        self.column.addWidget(self._hold)
        self._fold()

    def show_state(
        self, arm: ArmConnected, status: ArmStatus | None, has_stop_channel: bool, is_silent: bool
    ) -> None:
        """Show the arm's newest state."""
        self.heading.setText(arm.name)
        silence = self.tr(
            "The process that moves the arm does not respond: what is shown is old. STOP has its own channel."
        )
        say(self._silence, silence if is_silent else "")
        if status is None:
            return
        self._facts.set_facts(_state_facts(status, has_stop_channel))
        self._is_closed = bool(status.is_gripper_closed)
        said = self.tr("Hold to close the gripper")
        if self._is_closed:
            said = self.tr("Hold to open the gripper")
        if said != self._hold.text():
            self._hold.setText(said)
            self._hold.setAccessibleName(said)
            self._hold.updateGeometry()

    def allow(self, *, disconnecting: bool, gripping: bool) -> None:
        """Offer to disconnect, and to use the gripper: with the arm at rest and no cup in its hand."""
        self._disconnect.setVisible(disconnecting)
        if gripping != self._can_grip:
            self._can_grip = gripping
            self._fold()

    def unfold(self) -> None:
        """Show the gripper's button: it has to be opened."""
        self._unfold.setChecked(True)

    def _fold(self) -> None:
        self._unfold.setVisible(self._can_grip)
        is_open = self._can_grip and self._unfold.isChecked()
        self._warning.setVisible(is_open)
        self._hold.setVisible(is_open)

    def _link(self, name: str, text: str, tip: str) -> QPushButton:
        link = QPushButton(text)
        link.setObjectName(name)
        link.setProperty("role", "link")
        link.setToolTip(tip)
        return link


def _state_facts(status: ArmStatus, has_stop_channel: bool) -> list[Fact]:
    """Return how the arm is, as its controller reports it."""

    def tr(text: str) -> str:
        return QCoreApplication.translate("ArmState", text)

    state = status.state
    mode, safety, speed = tr("does not answer"), "--", "--"
    if state is not None:
        mode, safety = state.robot_mode.words, state.safety_mode.words
        speed = tr("{percent:.0f} %").format(percent=100 * state.speed_scaling)
    grip = {None: "--", True: tr("closed"), False: tr("open")}[status.is_gripper_closed]
    if status.is_gripper_closed and status.is_holding is not None:
        grip = tr("holds something") if status.is_holding else tr("closed, empty")
    if status.grip_width_m is not None:
        grip = tr("{grip}, {width:.0f} mm wide").format(grip=grip, width=1000 * status.grip_width_m)
    stop = tr("connected") if has_stop_channel else tr("via the arm's process")
    return [
        Fact(tr("Arm"), mode, tr("The controller's robot mode; 'running': power on, brakes released")),
        Fact(tr("Safety"), safety, tr("The controller's safety mode")),
        Fact(tr("Speed"), speed, tr("The factor for all speeds, set on the teach pendant's speed slider")),
        Fact(tr("Gripper"), grip, tr("As read back from the gripper, or from the tool's output")),
        Fact(
            tr("Stop channel"),
            stop,
            tr("STOP's direct connection to the controller. A software stop, not safety-rated."),
        ),
    ]
