"""What the driver asks of an arm at rest: several requests to the worker each, or one to the dashboard."""

from __future__ import annotations

import time
from contextlib import suppress
from itertools import product

import numpy as np

from core.geometry import FloatArray
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused, NotInRemoteControl, ProgramStopped, RobotError, RobotLost
from hardware.robots.ur.checks import deviation, refuse_local_control
from hardware.robots.ur.dashboard import Dashboard
from hardware.robots.ur.joint_limits import JointLimits
from hardware.robots.ur.link import WorkerLink
from hardware.robots.ur.messages import tool_outputs

_STOP_S, _LOST_STOP_S = 0.3, 0.1
"""Wait for the answer to an order to stop; once the link is lost hardly one comes, and that must be said."""
_OUTPUT_WITHIN_S = 0.5
_POLL_S = 0.004
_DIRECTIONS = np.array([step for step in product((-1, 0, 1), repeat=3) if step > (0, 0, 0)])
"""(13, 3) a cube's axes and diagonals, one way each: a plane's normal is at most 28 degrees from one."""
_ASKED_AT_ONCE = 10
"""Each takes some of the controller's cycles."""


def switch_tool_output(worker: WorkerLink, name: str, output: int, value: bool) -> None:
    """Set a digital output of the tool (0 or 1) and see that it is set.

    Measured with ur_rtde 1.6.5: the first write after a lost link is lost without an error. So the output is
    read back, and written once more if need be.

    Raises:
        MoveRefused: it does not change.
        RobotError: the robot, which people call `name`, cannot be reached.
    """
    for _ in range(2):
        worker.ask("set_tool_output", output, value)
        deadline_s = time.monotonic() + _OUTPUT_WITHIN_S
        while time.monotonic() < deadline_s:
            if tool_outputs(worker.state())[output] == value:
                return
            time.sleep(_POLL_S)
    raise MoveRefused(
        f"Tool output {output} of the {name} did not change; see under I/O on its panel whether something "
        "else sets it."
    )


def refuse_beyond_safety(
    worker: WorkerLink,
    limits: JointLimits | None,
    name: str,
    trajectory: JointTrajectory,
    label: str,
    tool_m: FloatArray,
) -> None:
    """Refuse a motion beyond the configured limits, where those are known, or those of the safety system.

    The latter knows joint limits, safety planes and the tool's tilt. It is asked about the motion's ends,
    where each joint is lowest and highest, and where the tool is outermost: there it passes a plane first.

    Args:
        worker: that asks.
        limits: of the joints; none: not known.
        name: of the robot, as people call it.
        trajectory: of the joints, N samples.
        label: of the motion.
        tool_m: (N, 3) the tool along it, in the base frame.

    Raises:
        MoveRefused: it does not allow it.
        RobotError: the robot does not answer.
    """
    if limits is not None:
        limits.refuse_beyond(trajectory, label, name)
    asked_rad = trajectory.joints_rad[_outermost(trajectory.joints_rad, tool_m)]
    for k in range(0, len(asked_rad), _ASKED_AT_ONCE):
        try:
            worker.ask("are_safe", asked_rad[k : k + _ASKED_AT_ONCE])
        except MoveRefused as refused:
            raise MoveRefused(
                f"In the move '{label}' the arm would come where the safety limits of the {name} do not "
                "allow it; see joint limits and planes under Installation, Safety, on its panel."
            ) from refused


def stop_program(dashboard: Dashboard, is_link_lost: bool) -> None:
    """End the program on the controller, and with it whatever moves.

    Raises:
        RobotLost: no answer came in time; the order may have come all the same.
    """
    dashboard.stop(_LOST_STOP_S if is_link_lost else _STOP_S)


def end_program_after(error: RobotError, dashboard: Dashboard, name: str) -> RobotError:
    """End our program after an error and return that, more exact where more is known by now."""
    try:
        stop_program(dashboard, isinstance(error, RobotLost))
        if isinstance(error, ProgramStopped):
            refuse_local_control(dashboard, name)
    except NotInRemoteControl as local:
        return local
    except RobotLost:
        pass  # The watchdog ends the program.
    return error


def end_stopped_program(worker: WorkerLink, dashboard: Dashboard, name: str) -> None:
    """End our program that a stop of the controller has paused, where the worker has not said so yet.

    Once the worker is gone nobody can tell whose program is paused; after a stop of ours neither.
    """
    with suppress(RobotLost):
        error = deviation(worker.state())
        if error is not None:
            end_program_after(error, dashboard, name)


def _outermost(joints_rad: FloatArray, tool_m: FloatArray) -> list[int]:
    rows = {0, len(joints_rad) - 1}
    for across in (joints_rad, tool_m @ _DIRECTIONS.T):
        rows |= {*across.argmin(axis=0).tolist(), *across.argmax(axis=0).tolist()}
    return sorted(rows)
