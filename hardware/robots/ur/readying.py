"""What has to be done before an arm can be connected, one step at a time, each known before it is taken."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.arm_models import ArmModel
from hardware.errors import ProgramStopped, RobotError, RobotNotReady
from hardware.grippers.robotiq_line import RobotiqAddress, activate, holds_object, is_activated
from hardware.interfaces import ReadyStep
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.checks import raise_if, refuse_other_kinematics, unsafe
from hardware.robots.ur.dashboard import Dashboard, restart_safety, switch_on, unlock
from hardware.robots.ur.glance import Glance
from hardware.robots.ur.messages import RUNTIME_PLAYING
from hardware.robots.ur.motions import ARRIVED_RAD
from hardware.robots.ur.pose_vectors import pose_from_vector
from hardware.robots.ur.probe import set_tool_voltage

RESTING_RAD_S = 0.01
_SAFETY_RESTARTS = (SafetyMode.FAULT, SafetyMode.VIOLATION)


@dataclass(frozen=True)
class Tool:
    """What is set for the tool on the controller.

    Attributes:
        voltage_v: supply of its connector; none: as set on the panel.
        tolerances: how far the reported tool may be from where the model's kinematics put it, in metres,
            and how far turned, in radians.
        robotiq: where a gripper is served that reports what it holds; none: an output, or nothing, is there.
    """

    voltage_v: int | None
    tolerances: tuple[float, float]
    robotiq: RobotiqAddress | None = None

    def holds(self, seen: Glance) -> bool:
        """Whether the hand holds something, as far as that is reported: an output that is on may.

        Raises:
            GripperError: the gripper does not answer.
        """
        return any(seen.tool_outputs) if self.robotiq is None else holds_object(self.robotiq)


def next_step(dashboard: Dashboard, seen: Glance, tool: Tool, name: str) -> tuple[ReadyStep, str] | None:
    """Return what has to be done first, and a sentence on what it is for; none if nothing is in the way."""
    program = dashboard.program()
    if program is not None:
        moves = ", and the arm moves" if seen.is_moving else ""
        if is_paused(program):
            return ReadyStep.END_PROGRAM, (
                f"A program is paused on the {name} ({program}), perhaps somebody else's; once ended, it "
                "cannot go on."
            )
        return ReadyStep.END_PROGRAM, (
            f"Another program is on the {name} ({program}){moves}; ending it stops what it does."
        )
    if seen.safety_mode in _SAFETY_RESTARTS:
        return ReadyStep.RESTART_SAFETY, (
            f"The safety system of the {name} is in '{seen.safety_mode.words}'; see on its panel why before "
            "it is started again."
        )
    if seen.safety_mode is SafetyMode.PROTECTIVE_STOP:
        return ReadyStep.UNLOCK, (
            f"The {name} is in a protective stop; see what the arm touched or what was too fast for it "
            "before it is unlocked."
        )
    if seen.safety_mode.may_move and seen.robot_mode is not RobotMode.RUNNING:
        is_on = seen.robot_mode is RobotMode.IDLE
        return (ReadyStep.RELEASE_BRAKES if is_on else ReadyStep.POWER_ON), (
            f"The {name} is in '{seen.robot_mode.words}'; "
            + ("its brakes are released" if is_on else "its power is switched on")
            + " when nobody is near."
        )
    if tool.robotiq is not None and not is_activated(tool.robotiq):
        return ReadyStep.ACTIVATE_GRIPPER, (
            f"The gripper of the {name} is not activated; its fingers open and close once then, so nothing "
            "must be in the hand, and no finger near it."
        )
    return None


def take_step(dashboard: Dashboard, step: ReadyStep, tool: Tool, name: str) -> None:
    """Do what has to be done; the arm does not move along any path.

    Raises:
        RobotError: it could not be done; the sentence says what a person has to do.
    """
    if step is ReadyStep.END_PROGRAM:
        dashboard.end_program()
    elif step is ReadyStep.RESTART_SAFETY:
        restart_safety(dashboard, name)
    elif step is ReadyStep.UNLOCK:
        unlock(dashboard, name)
    elif step is ReadyStep.ACTIVATE_GRIPPER:
        assert tool.robotiq is not None, "only such a gripper asks for it"
        activate(tool.robotiq)
    else:
        switch_on(dashboard, name, has_brakes_released=step is ReadyStep.RELEASE_BRAKES)


def refuse_taken(dashboard: Dashboard, seen: Glance, name: str) -> None:
    """Refuse a controller that another program or another client has: nothing is written to it.

    Raises:
        RobotNotReady: it has.
    """
    program = dashboard.program()
    if program is not None or not seen.has_free_inputs:
        what = "Another program" if program is None else f"Another program ({program})"
        moves = ", and the arm moves" if seen.is_moving else ""
        raise RobotNotReady(f"{what} drives the {name} already{moves}; end it, then recover the robot.")


def refuse_other_arm(seen: Glance, arm: ArmModel, tool: Tool) -> None:
    """Refuse an arm whose kinematics are not the model's, by the tool frame that is set on it now.

    Raises:
        WrongRobot: they are not.
    """
    if seen.tool_offset is not None:
        refuse_other_kinematics(
            np.array(seen.joints_rad),
            np.array(seen.tool_pose),
            arm,
            pose_from_vector(seen.tool_offset),
            tool.tolerances,
        )


def refuse_power_supply(seen: Glance, tool: Tool, name: str) -> None:
    """Refuse a tool connector whose outputs feed something in place of switching the gripper.

    Raises:
        RobotNotReady: they do.
    """
    if tool.voltage_v is not None and seen.has_dual_pin_power:
        raise RobotNotReady(
            f"The tool connector of the {name} is set to 'dual pin power', so that its outputs do not switch "
            "the gripper; choose 'digital output' under Installation, General, Tool I/O, on its panel."
        )


def supply_tool(address: str, seen: Glance, tool: Tool, name: str) -> None:
    """Set the tool's supply if it is not what it should be.

    Raises:
        RobotNotReady: it is not, and an output of the tool is on: what is held would drop.
        RobotLost: the controller at the address takes nothing.
    """
    if tool.voltage_v is None or seen.tool_voltage_v == tool.voltage_v:
        return
    if any(seen.tool_outputs) and seen.tool_voltage_v is not None:
        raise RobotNotReady(
            f"The tool connector of the {name} has {seen.tool_voltage_v} V where the cell file says "
            f"{tool.voltage_v} V, and a tool output is on: a change would drop what the gripper holds; empty "
            "the hand and switch the output off at the panel, or correct voltage_v."
        )
    set_tool_voltage(address, tool.voltage_v)


def refuse_busy(raw: AnyArray, start_rad: FloatArray, is_moving: bool, name: str) -> None:
    """Refuse to begin a motion at (6,) with an arm that is not ready, moves, or is elsewhere.

    Raises:
        RobotError: it is; the kind and the sentence say what.
    """
    raise_if(unsafe(raw))
    if int(raw["runtime_state"]) != RUNTIME_PLAYING:
        raise ProgramStopped(f"The control program on the {name} does not run any more; recover the robot.")
    if is_moving or np.abs(raw["joint_speeds_rad_s"]).max() > RESTING_RAD_S:
        raise RobotError(f"The {name} is still moving; stop it or wait until it stops.")
    if np.abs(start_rad - raw["joints_rad"]).max() > ARRIVED_RAD:
        raise RobotError(f"The {name} is not where the motion begins; plan it anew.")


_OURS_ENDS_WITHIN_S = 1.0
_POLL_S = 0.01


def is_paused(program: str) -> bool:
    """Whether a program, as the dashboard names it, does not run now."""
    return program.upper().startswith("PAUSED")


def refuse_foreign_program(dashboard: Dashboard, name: str, may_be_ours: Callable[[], bool]) -> None:
    """Refuse to recover where somebody else's program runs or is paused.

    Our own ends by its watchdog once its worker is gone, and is ended after each stop of the controller,
    which pauses it. When a link comes back, ur_rtde starts it again, without a watchdog: that one stays, and
    is asked about. A paused one may be anybody's, with work under way that ends with it.

    Raises:
        RobotNotReady: one stays.
    """
    deadline_s = time.monotonic() + _OURS_ENDS_WITHIN_S
    while (program := dashboard.program()) is not None:
        if time.monotonic() > deadline_s:
            if not is_paused(program) and may_be_ours():
                return
            what = "A program is paused" if is_paused(program) else "Another program runs"
            raise RobotNotReady(f"{what} on the {name} ({program}); end it, then recover the robot again.")
        time.sleep(_POLL_S)
