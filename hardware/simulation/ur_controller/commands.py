"""What each command code of ur_rtde's control script does to the arm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, invert_pose
from core.motion.kinematics import flange_pose, within_limits
from hardware.robots.joint_motion import JointMotion
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.courses import Course, StraightLine
from hardware.simulation.ur_controller.kinematics_service import combine, forward, has_solution, solve
from hardware.simulation.ur_controller.path_script import BlendedPath, PathMove, path_course
from hardware.simulation.ur_controller.poses import pose_from_vector, vector_from_pose
from hardware.simulation.ur_controller.progress import AsyncProgress
from hardware.simulation.ur_controller.registers import Registers

Waiting = Callable[[], bool]
"""Whether the command is done by now."""


@dataclass(frozen=True)
class Handler:
    """How a command is done.

    Attributes:
        run: does it, and returns what to wait for, or nothing if it is done at once.
        n_arguments: how many floating inputs belong to it, for the journal.
    """

    run: Callable[[Asked], Waiting | None]
    n_arguments: int


class Asked:
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
        self._steps_told = 0

    def six(self, first: int = 0) -> list[float]:
        """Six floating arguments."""
        return self.registers.double_inputs(first, 6)

    def number(self, index: int) -> float:
        """One floating argument."""
        return self.registers.double_inputs(index, 1)[0]

    def begin(self, make: Callable[[FloatArray], Course]) -> Waiting | None:
        """Begin a move; a synchronous one is waited for."""
        self.end_async()
        self._async_path = None
        self.arm.run(make)
        return self._wait_or_report(self.registers.int_input(1) == 1)

    def begin_path(self) -> Waiting | None:
        """Begin the moves that were put into the script."""
        if not self._path:
            return None

        def make(start_rad: FloatArray) -> Course:
            course = path_course(self.arm.model, self.arm.T_flange_tcp, self._path, start_rad)
            self._async_path = course if self._progress.is_running else None
            return course

        self.end_async()
        is_async = self.registers.int_input(1) == 1
        waiting = self._wait_or_report(is_async)
        self.arm.run(make)
        return waiting

    def stop(self, brake: Callable[[float], None]) -> Waiting | None:
        """End what is going on with a deceleration; waits for the stand unless asked not to."""
        self.end_async()
        brake(self.number(0))
        return self._wait_or_report(self.registers.int_input(1) == 1)

    def end_async(self) -> None:
        """Let an asynchronous command be over."""
        if self._progress.is_running:
            self._progress.finished()
        self._async_path = None

    def follow_async(self) -> None:
        """Tell how far an asynchronous command has come."""
        if not self._progress.is_running:
            return
        if self._async_path is not None:
            step = int(self._async_path.at(self.arm.course_time_s)[2])
            if step > self._steps_told:
                self._steps_told = step
                self._progress.reached(step)
        if self.arm.is_idle:
            self.end_async()

    def _wait_or_report(self, is_async: bool) -> Waiting | None:
        if not is_async:
            return lambda: self.arm.is_idle
        self._steps_told = 0
        self._progress.started()
        return None


def _joint_move(asked: Asked, target_rad: FloatArray) -> Waiting | None:
    speed = float(np.clip(asked.number(6), 1e-3, min(asked.arm.model.speed_limits_rad_s)))
    acceleration = max(asked.number(7), 1e-3)
    return asked.begin(lambda start: JointMotion(np.stack([start, target_rad]), speed, acceleration))


def _line(asked: Asked, T_base_flange: FloatArray) -> Waiting | None:
    speed, acceleration = max(asked.number(6), 1e-3), max(asked.number(7), 1e-3)
    return asked.begin(lambda start: StraightLine(asked.arm.model, start, T_base_flange, speed, acceleration))


def _move_j(asked: Asked) -> Waiting | None:
    return _joint_move(asked, np.array(asked.six()))


def _move_j_ik(asked: Asked) -> Waiting | None:
    return _joint_move(asked, solve(asked.arm, asked.six(), asked.arm.target_rad))


def _move_l(asked: Asked) -> Waiting | None:
    return _line(asked, pose_from_vector(asked.six()) @ invert_pose(asked.arm.T_flange_tcp))


def _move_l_fk(asked: Asked) -> Waiting | None:
    return _line(asked, flange_pose(asked.arm.model, np.array(asked.six())))


def _speed_j(asked: Asked) -> None:
    asked.end_async()
    asked.arm.speed().aim(np.array(asked.six()), asked.number(6), is_tool=False)


def _speed_l(asked: Asked) -> None:
    asked.end_async()
    asked.arm.speed().aim(np.array(asked.six()), asked.number(6), is_tool=True)


def _servo(asked: Asked, target_rad: FloatArray) -> None:
    asked.end_async()
    asked.arm.servo().aim(target_rad, lookahead_s=asked.number(9), gain=asked.number(10))


def _servo_j(asked: Asked) -> None:
    _servo(asked, np.array(asked.six()))


def _servo_l(asked: Asked) -> None:
    _servo(asked, solve(asked.arm, asked.six(), asked.arm.target_rad))


def _stop_j(asked: Asked) -> Waiting | None:
    return asked.stop(asked.arm.brake)


def _stop_l(asked: Asked) -> Waiting | None:
    return asked.stop(asked.arm.brake_tool)


def _end_following(asked: Asked) -> Waiting:
    """After servoing or a speed: the recipe has no asynchronous flag."""
    asked.end_async()
    asked.arm.brake(asked.number(0))
    return lambda: asked.arm.is_idle


def _payload(asked: Asked) -> None:
    asked.arm.payload_kg, x, y, z = asked.registers.double_inputs(0, 4)
    asked.arm.payload_center_m = (x, y, z)


def _set_tcp(asked: Asked) -> None:
    asked.arm.T_flange_tcp = pose_from_vector(asked.six())


def _tcp_offset(asked: Asked) -> None:
    asked.registers.write_doubles(vector_from_pose(asked.arm.T_flange_tcp))


def _inverse(asked: Asked, near_rad: FloatArray) -> None:
    asked.registers.write_doubles(solve(asked.arm, asked.six(), near_rad))


def _watchdog(asked: Asked) -> None:
    frequency_hz = asked.number(0)
    asked.watchdog_s = 1 / frequency_hz if frequency_hz > 0 else None


def _answer(asked: Asked, is_so: bool) -> None:
    asked.registers.ints[1] = int(is_so)


def _has_solution(asked: Asked, near_rad: FloatArray) -> None:
    _answer(asked, has_solution(asked.arm, asked.six(), near_rad))


def _joints_are_safe(asked: Asked) -> None:
    _answer(asked, bool(within_limits(asked.arm.model, asked.six()).all()))


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
    30: Handler(lambda asked: _inverse(asked, np.array(asked.six(6))), 12),
    31: Handler(lambda asked: asked.trigger_protective_stop(), 0),
    33: Handler(_stop_l, 1),
    34: Handler(_stop_j, 1),
    35: Handler(_watchdog, 1),
    36: Handler(lambda asked: _has_solution(asked, asked.arm.target_rad), 6),
    37: Handler(_joints_are_safe, 6),
    39: Handler(lambda asked: asked.registers.write_doubles(combine(asked.six(), asked.six(6))), 12),
    40: Handler(_tcp_offset, 0),
    43: Handler(lambda asked: asked.registers.write_doubles(asked.arm.tcp_pose(asked.arm.target_rad)), 0),
    44: Handler(
        lambda asked: asked.registers.write_doubles(forward(asked.arm, np.array(asked.six()), asked.six(6))),
        12,
    ),
    45: Handler(Asked.begin_path, 0),
    46: Handler(lambda asked: _inverse(asked, asked.arm.target_rad), 6),
    47: Handler(lambda asked: _answer(asked, not asked.arm.is_moving), 0),
    60: Handler(lambda asked: _has_solution(asked, asked.arm.target_rad), 6),
    61: Handler(lambda asked: _has_solution(asked, np.array(asked.six(6))), 12),
}
"""By code. Other codes do nothing and are done at once, as are those that the real script does not know."""
