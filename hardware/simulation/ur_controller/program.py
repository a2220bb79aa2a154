"""The control script that ur_rtde uploads, played natively: commands in registers, answers in registers.

The script itself is not interpreted. What it does with each command was taken from its text (ur_rtde 1.6.5).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, invert_pose
from core.motion.kinematics import flange_pose
from hardware.robots.joint_motion import JointMotion
from hardware.robots.ur.pose_vectors import pose_from_vector, vector_from_pose
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.motions import StraightLine, Trajectory
from hardware.simulation.ur_controller.path_script import BlendedPath, PathMove, injected_moves, plan_path
from hardware.simulation.ur_controller.registers import AsyncProgress, Registers

Waiting = Callable[[], bool]
"""Whether the command is done by now."""


@dataclass(frozen=True)
class Handler:
    """How a command is done.

    Attributes:
        run: does it, and returns what to wait for, or nothing if it is done at once.
        n_arguments: how many floating inputs belong to it, for the journal.
    """

    run: Callable[[CommandContext], Waiting | None]
    n_arguments: int


class CommandContext:
    """What the commands work on, and how they begin moves.

    Attributes:
        arm: the arm.
        registers: arguments and answers.
        watchdog_s: the longest time between two writes of the command register; none if not asked for.
        trigger_protective_stop: does what its name says.
    """

    def __init__(
        self,
        arm: Arm,
        registers: Registers,
        progress: AsyncProgress,
        path: Sequence[PathMove],
        trigger_protective_stop: Callable[[], None],
    ) -> None:
        """Begin with no command."""
        self.arm = arm
        self.registers = registers
        self.watchdog_s: float | None = None
        self.trigger_protective_stop = trigger_protective_stop
        self._progress = progress
        self._path = path
        self._async_path: BlendedPath | None = None
        self._steps_reported = 0

    def six(self, first: int = 0) -> list[float]:
        """Six floating arguments."""
        return self.registers.double_inputs(first, 6)

    def number(self, index: int) -> float:
        """One floating argument."""
        return self.registers.double_inputs(index, 1)[0]

    def begin(self, make: Callable[[FloatArray], Trajectory]) -> Waiting | None:
        """Begin a move; a synchronous one is waited for."""
        self.end_async()
        self._async_path = None
        self.arm.run(make)
        return self._wait_or_report(self.registers.int_input(1) == 1)

    def begin_path(self) -> Waiting | None:
        """Begin the moves that were put into the script."""
        if not self._path:
            return None

        def make(start_rad: FloatArray) -> Trajectory:
            trajectory = plan_path(self.arm.model, self.arm.T_flange_tcp, self._path, start_rad)
            self._async_path = trajectory if self._progress.is_running else None
            return trajectory

        self.end_async()
        is_async = self.registers.int_input(1) == 1
        waiting = self._wait_or_report(is_async)
        self.arm.run(make)
        return waiting

    def stop(self, brake: Callable[[float], None]) -> Waiting | None:
        """End what is going on with a deceleration; waits for the arm to stop unless asked not to."""
        self.end_async()
        brake(self.number(0))
        return self._wait_or_report(self.registers.int_input(1) == 1)

    def end_async(self) -> None:
        """Let an asynchronous command be over."""
        if self._progress.is_running:
            self._progress.finished()
        self._async_path = None

    def follow_async(self) -> None:
        """Report how far an asynchronous command has come."""
        if not self._progress.is_running:
            return
        if self._async_path is not None:
            step = int(self._async_path.at(self.arm.planned_time_s)[2])
            if step > self._steps_reported:
                self._steps_reported = step
                self._progress.reached(step)
        if self.arm.is_idle:
            self.end_async()

    def _wait_or_report(self, is_async: bool) -> Waiting | None:
        if not is_async:
            return lambda: self.arm.is_idle
        self._steps_reported = 0
        self._progress.started()
        return None


def _joint_move(context: CommandContext, target_rad: FloatArray) -> Waiting | None:
    speed = float(np.clip(context.number(6), 1e-3, min(context.arm.model.speed_limits_rad_s)))
    acceleration = max(context.number(7), 1e-3)
    return context.begin(lambda start: JointMotion(np.stack([start, target_rad]), speed, acceleration))


def _line(context: CommandContext, T_base_flange: FloatArray) -> Waiting | None:
    speed, acceleration = max(context.number(6), 1e-3), max(context.number(7), 1e-3)
    return context.begin(
        lambda start: StraightLine(context.arm.model, start, T_base_flange, speed, acceleration)
    )


def _move_j(context: CommandContext) -> Waiting | None:
    return _joint_move(context, np.array(context.six()))


def _move_j_ik(context: CommandContext) -> Waiting | None:
    return _joint_move(context, context.arm.solve(context.six(), context.arm.target_rad))


def _move_l(context: CommandContext) -> Waiting | None:
    return _line(context, pose_from_vector(context.six()) @ invert_pose(context.arm.T_flange_tcp))


def _move_l_fk(context: CommandContext) -> Waiting | None:
    return _line(context, flange_pose(context.arm.model, np.array(context.six())))


def _speed_j(context: CommandContext) -> None:
    context.end_async()
    context.arm.speed().aim(np.array(context.six()), context.number(6), is_tool=False)


def _speed_l(context: CommandContext) -> None:
    context.end_async()
    context.arm.speed().aim(np.array(context.six()), context.number(6), is_tool=True)


def _servo(context: CommandContext, target_rad: FloatArray) -> None:
    context.end_async()
    context.arm.servo().aim(target_rad, lookahead_s=context.number(9), gain=context.number(10))


def _servo_j(context: CommandContext) -> None:
    _servo(context, np.array(context.six()))


def _servo_l(context: CommandContext) -> None:
    _servo(context, context.arm.solve(context.six(), context.arm.target_rad))


def _stop_j(context: CommandContext) -> Waiting | None:
    return context.stop(context.arm.brake)


def _stop_l(context: CommandContext) -> Waiting | None:
    return context.stop(context.arm.brake_tool)


def _end_following(context: CommandContext) -> Waiting:
    """After servoing or a speed: the recipe has no asynchronous flag."""
    context.end_async()
    context.arm.brake(context.number(0))
    return lambda: context.arm.is_idle


def _payload(context: CommandContext) -> None:
    context.arm.payload_kg, x, y, z = context.registers.double_inputs(0, 4)
    context.arm.payload_center_m = (x, y, z)


def _set_tcp(context: CommandContext) -> None:
    context.arm.T_flange_tcp = pose_from_vector(context.six())


def _tcp_offset(context: CommandContext) -> None:
    context.registers.write_doubles(vector_from_pose(context.arm.T_flange_tcp))


def _inverse(context: CommandContext, near_rad: FloatArray) -> None:
    context.registers.write_doubles(context.arm.solve(context.six(), near_rad))


def _forward(context: CommandContext) -> None:
    """Where a tool, given in the flange frame, is at a configuration."""
    T_base_flange = flange_pose(context.arm.model, np.array(context.six()))
    context.registers.write_doubles(vector_from_pose(T_base_flange @ pose_from_vector(context.six(6))))


def _product(context: CommandContext) -> None:
    """One pose seen through another (pose_trans)."""
    first, second = pose_from_vector(context.six()), pose_from_vector(context.six(6))
    context.registers.write_doubles(vector_from_pose(first @ second))


def _watchdog(context: CommandContext) -> None:
    frequency_hz = context.number(0)
    context.watchdog_s = 1 / frequency_hz if frequency_hz > 0 else None


def _answer(context: CommandContext, is_so: bool) -> None:
    context.registers.ints[1] = int(is_so)


def _has_solution(context: CommandContext, near_rad: FloatArray) -> None:
    _answer(context, context.arm.has_solution(context.six(), near_rad))


def _joints_are_safe(context: CommandContext) -> None:
    _answer(context, context.arm.is_safe(context.six()))


HANDLERS: dict[int, Handler] = {
    1: Handler(_move_j, 8),
    2: Handler(_move_j_ik, 8),
    3: Handler(_move_l, 8),
    4: Handler(_move_l_fk, 8),
    9: Handler(_speed_j, 8),
    10: Handler(_speed_l, 8),
    11: Handler(_servo_j, 11),
    15: Handler(_end_following, 1),
    16: Handler(_end_following, 1),
    17: Handler(_payload, 4),
    24: Handler(_servo_l, 11),
    29: Handler(_set_tcp, 6),
    30: Handler(lambda context: _inverse(context, np.array(context.six(6))), 12),
    31: Handler(lambda context: context.trigger_protective_stop(), 0),
    33: Handler(_stop_l, 1),
    34: Handler(_stop_j, 1),
    35: Handler(_watchdog, 1),
    36: Handler(lambda context: _has_solution(context, context.arm.target_rad), 6),
    37: Handler(_joints_are_safe, 6),
    39: Handler(_product, 12),
    40: Handler(_tcp_offset, 0),
    43: Handler(
        lambda context: context.registers.write_doubles(context.arm.tcp_pose(context.arm.target_rad)), 0
    ),
    44: Handler(_forward, 12),
    45: Handler(CommandContext.begin_path, 0),
    46: Handler(lambda context: _inverse(context, context.arm.target_rad), 6),
    47: Handler(lambda context: _answer(context, not context.arm.is_moving), 0),
    60: Handler(lambda context: _has_solution(context, context.arm.target_rad), 6),
    61: Handler(lambda context: _has_solution(context, np.array(context.six(6))), 12),
}
"""By code. Other codes do nothing and are done at once, as are those that the real script does not know."""


_READY, _DONE = 1, 2
_STOP_SCRIPT = 255
_REAL_TIME = {6, 9, 10, 11, 24, 25, 26, 27, 38, 58, *range(66, 72)}
"""These are taken in every cycle and get no 'done'."""


class ControlProgram:
    """The running script.

    Attributes:
        is_over: whether it has ended by itself.
        name: as the dashboard calls it: a script that came over the network has none.
    """

    name = "<unnamed>"

    def __init__(
        self,
        script: str,
        arm: Arm,
        registers: Registers,
        journal: Journal,
        protective_stop: Callable[[], None],
    ) -> None:
        """Begin: no command is under way, no asynchronous one is running."""
        self.is_over = False
        self._registers = registers
        self._journal = journal
        self._progress = AsyncProgress(registers)
        self._context = CommandContext(
            arm, registers, self._progress, injected_moves(script), protective_stop
        )
        self._is_executing = False
        self._waiting: Callable[[], bool] | None = None
        self._last_noted: tuple[int, list[float]] | None = None
        self._progress.finished()
        registers.ints[0] = _READY

    def step(self) -> None:
        """Do what the script does in one cycle.

        Raises:
            NoSolution: the real script ends with an error here.
        """
        if self._starves():
            self._journal.note("watchdog starved")
            self.is_over = True
            return
        self._context.follow_async()
        if self._waiting is not None:
            if self._waiting():
                self._waiting = None
                self._registers.ints[0] = _DONE
            return
        self._next_command(self._registers.int_input(0))

    def _next_command(self, code: int) -> None:
        if code == 0:
            self._is_executing = False
            self._last_noted = None
            self._registers.ints[0] = _READY
        elif code in _REAL_TIME:
            self._execute(code)
            self._registers.ints[0] = _READY
        elif not self._is_executing:
            self._is_executing = True
            if code == _STOP_SCRIPT:
                self._note(code, [], is_known=True)
                self.is_over = True
                return
            self._waiting = self._execute(code)
            if self._waiting is None:
                self._registers.ints[0] = _DONE

    def _execute(self, code: int) -> Callable[[], bool] | None:
        handler = HANDLERS.get(code)
        arguments = self._registers.double_inputs(0, handler.n_arguments if handler else 0)
        self._note(code, arguments, is_known=handler is not None)
        return handler.run(self._context) if handler else None

    def _note(self, code: int, arguments: list[float], is_known: bool) -> None:
        """Note a command; of a stream of real-time ones the first, and how many had new arguments."""
        if (code, arguments) == self._last_noted:
            return
        is_next_of_stream = self._last_noted is not None and self._last_noted[0] == code
        self._last_noted = (code, arguments)
        self._journal.counts[f"command {code}"] += 1
        if not is_next_of_stream:
            self._journal.note("command", code=code, arguments=arguments, is_known=is_known)

    def _starves(self) -> bool:
        period_s = self._context.watchdog_s
        return period_s is not None and self._registers.command_age_s() > period_s
