"""The controller's state: power, safety, the program's life, and one cycle of it all."""

from __future__ import annotations

import re
from enum import IntEnum

import numpy.typing as npt

from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics, calibrated
from hardware.modes import RobotMode, SafetyMode
from hardware.simulation.ur_controller.arm import STOP_RAD_S2, Arm
from hardware.simulation.ur_controller.foreign import ForeignProgram
from hardware.simulation.ur_controller.identity import Identity
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.motions import NoSolution
from hardware.simulation.ur_controller.program import ControlProgram
from hardware.simulation.ur_controller.registers import Registers
from hardware.simulation.ur_controller.robotiq import RobotiqHand

CONTROL_SCRIPT_MARK = "def rtde_control():"
_SWITCHING_S = 1.0
"""Powering on and releasing the brakes; the real ones take longer, but nobody gains by waiting."""
_UNLOCK_AFTER_S = 5.0
_GAP_S = 0.1
TOOL_OUTPUT_BIT = 16
"""Of the digital outputs 16 and 17 are the tool's."""


class RuntimeState(IntEnum):
    """What the program does; RTDE's numbers."""

    STOPPING = 0
    STOPPED = 1
    PLAYING = 2
    PAUSING = 3
    PAUSED = 4
    RESUMING = 5


class Controller:
    """Everything but the sockets.

    Attributes:
        identity: which controller it is.
        measured: its arm's own kinematics; none: they are the model's.
        dt_s: one cycle.
        time_s: the controller's own clock.
        arm: the arm.
        registers: what clients and the program write.
        journal: what happened.
        robot_mode, safety_mode, runtime_state: as RTDE reports them.
        is_remote: whether it is in remote control (e-Series; always so on a CB3).
        ignores_uploads: a fault: scripts come and nothing happens.
        tool_voltage_v: supply of the tool connector.
        ignores_outputs: a fault: outputs are written and nothing happens.
        dashboard_delay_s: how late the dashboard hears every line.
        speed_up: how many times faster than the wall clock its clock runs.
        tool_force_n: what pushes at the tool.
        has_dual_pin_power: whether the tool's outputs are its power supply (e-Series).
        is_frozen: whether nothing happens any more, for now.
        digital_outputs: bits; 16 and 17 are the tool's.
        hand: a Robotiq gripper; none: there is none.
    """

    def __init__(
        self, identity: Identity, joints_rad: npt.ArrayLike, measured: MeasuredKinematics | None = None
    ) -> None:
        """Be switched on, brakes released, no program; the arm's own kinematics are as measured."""
        self.identity = identity
        self.measured = measured
        self.dt_s = 1 / identity.rate_hz
        self.time_s = 0.0
        own = identity.model if measured is None else calibrated(identity.model, measured)
        self.arm = Arm(own, joints_rad)
        self.registers = Registers()
        self.journal = Journal()
        self.robot_mode = RobotMode.RUNNING
        self.safety_mode = SafetyMode.NORMAL
        self.runtime_state = RuntimeState.STOPPED
        self.is_remote = True
        self.ignores_uploads = False
        self.tool_voltage_v = 24
        self.ignores_outputs = False
        self.dashboard_delay_s = 0.0
        self.speed_up = 1.0
        self.tool_force_n = 0.0
        self.has_dual_pin_power = False
        self.is_frozen = False
        self.digital_outputs = 0
        self.hand: RobotiqHand | None = None
        self._cycles = 0
        self._program: ControlProgram | ForeignProgram | None = None
        self._stopped_until_s = 0.0
        self._is_hung = False
        self._stopped_at_s = 0.0
        self._switching: list[tuple[float, RobotMode]] = []

    @property
    def program_name(self) -> str:
        """Of the program under way, as the dashboard calls it."""
        return ControlProgram.name if self._program is None else self._program.name

    def step(self) -> None:
        """One cycle."""
        if self.is_frozen:
            return
        self._cycles += 1
        self.time_s = self._cycles * self.dt_s
        self.journal.set_time(self.time_s)
        try:
            if self._is_hung:
                self.registers.ints[0] = 0
            elif self._program is not None and self.runtime_state is RuntimeState.PLAYING:
                self._program.step()
            self.arm.step(self.dt_s)
            if self.hand is not None:
                self.hand.step(self.dt_s)
        except NoSolution as error:
            self.journal.note("script error", message=str(error))
            self._end_program()
        if self._program is not None and self._program.is_over:
            self._end_program()
        if self.arm.is_beyond_safety:
            self.protective_stop()
        self._advance_runtime()
        self._advance_power()

    def upload(self, script: str) -> None:
        """Take a script; it replaces the old one, unless it is a secondary program, which runs beside it."""
        is_control = CONTROL_SCRIPT_MARK in script
        taken = self._takes_scripts()
        self.journal.note("script", size=len(script), is_control_script=is_control, is_taken=taken)
        if not taken:
            return
        if script.lstrip().startswith("sec "):
            voltage = re.search(r"set_tool_voltage\((\d+)\)", script)
            self.tool_voltage_v = int(voltage[1]) if voltage else self.tool_voltage_v
            return
        self._end_program()
        if is_control:
            self._program = ControlProgram(
                script, self.arm, self.registers, self.journal, self.protective_stop
            )
            self.arm.is_held = False
            self.runtime_state = RuntimeState.PLAYING

    def run_foreign(self, is_moving: bool, has_gap: bool) -> None:
        """Let another program take over, with or without a moment in which none runs."""
        self._end_program()
        self.journal.note("foreign program", is_moving=is_moving)
        self._program = ForeignProgram(self.arm, is_moving)
        self._stopped_until_s = self.time_s + (_GAP_S if has_gap else 0.0)
        self.runtime_state = RuntimeState.STOPPED if has_gap else RuntimeState.PLAYING

    def hang_program(self) -> None:
        """Let the program take no further command, while it counts as running."""
        self._is_hung = True
        self.journal.note("program hangs")

    def stop(self) -> bool:
        """End the program; False if there is none."""
        had_one = self._program is not None
        self._end_program()
        return had_one

    def pause(self) -> bool:
        """Pause the program; False if it does not run."""
        if self.runtime_state not in (RuntimeState.PLAYING, RuntimeState.RESUMING):
            return False
        self.arm.is_held = True
        self.runtime_state = RuntimeState.PAUSING
        return True

    def play(self) -> bool:
        """Let a paused program go on, with the move that it was in; False if that cannot be."""
        may = self.safety_mode.may_move and self.robot_mode is RobotMode.RUNNING
        if not may or self.runtime_state not in (RuntimeState.PAUSING, RuntimeState.PAUSED):
            return False
        self.arm.is_held = False
        self.runtime_state = RuntimeState.RESUMING
        return True

    def protective_stop(self) -> None:
        """Stop the motion and hold; the program is paused."""
        if self.safety_mode.may_move:
            self.safety_mode = SafetyMode.PROTECTIVE_STOP
            self._stopped_at_s = self.time_s
            self.journal.note("protective stop")
            if not self.pause():
                self.arm.is_held = True

    def unlock_protective_stop(self) -> bool:
        """End a protective stop; False within 5 s of it. The program stays paused."""
        if self.safety_mode is not SafetyMode.PROTECTIVE_STOP:
            return True
        if self.time_s - self._stopped_at_s < _UNLOCK_AFTER_S:
            return False
        self.safety_mode = SafetyMode.NORMAL
        if self._program is None:
            self.arm.is_held = False
        return True

    def emergency_stop(self) -> None:
        """Stop, end the program, and take the power from the arm."""
        self.safety_mode = SafetyMode.ROBOT_EMERGENCY_STOP
        self.journal.note("emergency stop")
        self.power_off()

    def release_emergency_stop(self) -> None:
        """Pull the button out again; the arm stays off."""
        if self.safety_mode is SafetyMode.ROBOT_EMERGENCY_STOP:
            self.safety_mode = SafetyMode.NORMAL

    def safety_fault(self) -> None:
        """Stop with a fault that only a restart of the safety system ends."""
        self.safety_mode = SafetyMode.FAULT
        self.power_off()

    def restart_safety(self) -> None:
        """End a fault or violation; the arm stays off."""
        if self.safety_mode in (SafetyMode.FAULT, SafetyMode.VIOLATION):
            self.safety_mode = SafetyMode.NORMAL

    def power_off(self) -> None:
        """Brake, end the program, and take the power from the arm."""
        self._end_program()
        self.arm.is_held = False
        self.arm.brake(STOP_RAD_S2)
        self._switching = [(0.0, RobotMode.POWER_OFF)]

    def power_on(self) -> None:
        """Give power to the arm; its brakes stay on."""
        if self.robot_mode is RobotMode.POWER_OFF and self.safety_mode.may_move:
            self.robot_mode = RobotMode.POWER_ON
            self._switching = [(self.time_s + _SWITCHING_S, RobotMode.IDLE)]

    def release_brakes(self) -> None:
        """Release the brakes, after powering on if need be."""
        self.power_on()
        if self.robot_mode in (RobotMode.POWER_ON, RobotMode.IDLE):
            begin_s = max([self.time_s, *(due_s for due_s, _ in self._switching)])
            self._switching.append((begin_s + _SWITCHING_S, RobotMode.RUNNING))

    def lose_outputs(self) -> None:
        """Switch the tool's outputs off, as a short circuit or a broken cable does."""
        self.digital_outputs &= ~(0b11 << TOOL_OUTPUT_BIT)
        self.journal.note("outputs lost")

    def reduce(self, is_reduced: bool) -> None:
        """Let the safety system be in reduced mode, or in its normal one."""
        self.safety_mode = SafetyMode.REDUCED if is_reduced else SafetyMode.NORMAL

    def set_model(self, model: ArmModel) -> None:
        """Be another arm from now on: a fault of the cell, found by its kinematics."""
        self.arm.model = model
        self.measured = None

    def _takes_scripts(self) -> bool:
        is_ready = self.robot_mode is RobotMode.RUNNING and not self._switching
        return is_ready and self.safety_mode.may_move and self.is_remote and not self.ignores_uploads

    def _end_program(self) -> None:
        if self._program is None:
            return
        self._program, self._is_hung = None, False
        self.journal.note("end of program")
        self.arm.is_held = False
        self.arm.brake(STOP_RAD_S2)
        self.runtime_state = RuntimeState.STOPPING

    def _advance_runtime(self) -> None:
        if self.runtime_state is RuntimeState.STOPPED and self._program is not None:
            if self.time_s >= self._stopped_until_s:
                self.runtime_state = RuntimeState.PLAYING
        elif self.runtime_state is RuntimeState.STOPPING and not self.arm.is_moving:
            self.runtime_state = RuntimeState.STOPPED
        elif self.runtime_state is RuntimeState.PAUSING and self.arm.is_paused:
            self.runtime_state = RuntimeState.PAUSED
        elif self.runtime_state is RuntimeState.RESUMING:
            self.runtime_state = RuntimeState.PLAYING

    def _advance_power(self) -> None:
        if self._switching and self.time_s >= self._switching[0][0] and not self.arm.is_moving:
            self.robot_mode = self._switching.pop(0)[1]
            self.journal.note("robot mode", mode=self.robot_mode.name)
