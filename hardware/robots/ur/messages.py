"""What the driver and its worker process send each other: requests, replies, and a state at every cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from core.child_process import SPAWN
from core.geometry import AnyArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from hardware.errors import RobotError
from hardware.grippers.robotiq_line import RobotiqAddress
from hardware.interfaces import RobotState
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.pose_vectors import pose_from_vector


@dataclass(frozen=True)
class Setup:
    """What the worker has to know to connect.

    Attributes:
        address: the controller's.
        tool: (6) `T_flange_tool` as the controller writes it: metres and a rotation vector.
        payload_kg: mass at the flange.
        payload_center_m: (3) its centre, in the flange's frame.
        cycle_s: time between two of the controller's states.
        robotiq: where a gripper is served that tells whether it holds something; none: there is none.
        is_held: whether it does now, so that it is watched.
    """

    address: str
    tool: list[float]
    payload_kg: float
    payload_center_m: list[float]
    cycle_s: float
    robotiq: RobotiqAddress | None = None
    is_held: bool = False


@dataclass(frozen=True)
class Request:
    """A call of one of the worker's methods."""

    number: int
    name: str
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class Reply:
    """What came of a request."""

    number: int
    error: RobotError | None


@dataclass(frozen=True)
class Started:
    """The worker's first message: its process runs, and begins to connect."""


@dataclass(frozen=True)
class Connected:
    """The worker's second message: it is connected, or why it is not."""

    error: RobotError | None


@dataclass(frozen=True)
class Ended:
    """The present move is over: at its target, or elsewhere, for a reason, after a share of its path."""

    error: RobotError | None
    progress: float


RUNTIME_PLAYING = 2
"""The runtime state of a controller whose program runs; all others lead to or from a stop."""

FIELDS = np.dtype(
    [
        ("time_s", "f8"),
        ("controller_s", "f8"),
        ("joints_rad", "f8", 6),
        ("target_joints_rad", "f8", 6),
        ("joint_speeds_rad_s", "f8", 6),
        ("tool_pose", "f8", 6),
        ("speed_scaling", "f8"),
        ("robot_mode", "i8"),
        ("safety_mode", "i8"),
        ("runtime_state", "i8"),
        ("output_bits", "i8"),
        ("progress", "f8"),
        ("due_s", "f8"),
        ("tool_force_n", "f8"),
    ]
)
"""One state; `tool_pose` is metres and a rotation vector, `time_s` is `time.monotonic`, which all processes
of a machine share, `progress` is the share of the present move, `due_s` the `time.monotonic` by which the
thread that makes the control calls should have been heard again."""

_COUNT_BYTES = 8


class Pulse:
    """A counter that the driver keeps counting, so that its worker knows whether the program still runs."""

    def __init__(self) -> None:
        """Begin at 0, in memory that a spawned process shares when it is handed over."""
        self._memory = SPAWN.RawArray("q", 1)

    def beat(self) -> None:
        """Count one on."""
        self._memory[0] += 1

    @property
    def count(self) -> int:
        """How often it beat."""
        return int(self._memory[0])


class StateMailbox:
    """Holds the newest state; one process writes, any number of threads read, nobody ever waits.

    The writer fills one of two places and then says which by a counter, so a writer that is killed or frozen
    at any moment leaves a whole state behind.
    """

    def __init__(self) -> None:
        """Make it empty, in memory that a spawned process shares when it is handed over."""
        self._memory = SPAWN.RawArray("b", _COUNT_BYTES + 2 * FIELDS.itemsize)

    def write(self, state: AnyArray) -> None:
        """Make a state (a scalar of `FIELDS`) the newest."""
        count, places = self._views()
        places[(count[0] + 1) % 2] = state
        count[0] += 1

    def read(self) -> AnyArray | None:
        """Return the newest state; none before the first."""
        count, places = self._views()
        while True:
            before = int(count[0])
            if before == 0:
                return None
            newest = places[before % 2].copy()
            if count[0] == before:
                return np.asarray(newest)

    def _views(self) -> tuple[Any, Any]:
        memory = memoryview(self._memory)
        count = np.frombuffer(memory, np.int64, count=1)
        return count, np.frombuffer(memory, FIELDS, offset=_COUNT_BYTES)


def known_robot_mode(number: int) -> RobotMode:
    """How far the arm is switched on; a number that nobody knows is not ready."""
    return RobotMode(number) if number in set(RobotMode) else RobotMode.NO_CONTROLLER


def known_safety_mode(number: int) -> SafetyMode:
    """Whether the safety system lets the arm move; a number that nobody knows does not."""
    return SafetyMode(number) if number in set(SafetyMode) else SafetyMode.UNDEFINED


def robot_mode(raw: AnyArray) -> RobotMode:
    """How far the arm is switched on, by a state of `FIELDS`."""
    return known_robot_mode(int(raw["robot_mode"]))


def safety_mode(raw: AnyArray) -> SafetyMode:
    """Whether the safety system lets the arm move, by a state of `FIELDS`."""
    return known_safety_mode(int(raw["safety_mode"]))


_TOOL_OUTPUT_BIT = 16
"""Of the digital outputs 0-7 are the cabinet's, 8-15 configurable, 16 and 17 the tool's."""


def tool_outputs(raw: AnyArray) -> tuple[bool, bool]:
    """The two digital outputs of the tool."""
    bits = int(raw["output_bits"]) >> _TOOL_OUTPUT_BIT
    return bool(bits & 1), bool(bits & 2)


def robot_state(raw: AnyArray, arm: ArmModel) -> RobotState:
    """Return a state of `FIELDS` as the interface defines it."""
    return RobotState(
        joints_rad=raw["joints_rad"],
        target_joints_rad=raw["target_joints_rad"],
        joint_speeds_rad_s=raw["joint_speeds_rad_s"],
        T_base_flange=flange_pose(arm, raw["joints_rad"]),
        T_base_tool=pose_from_vector(raw["tool_pose"]),
        robot_mode=robot_mode(raw),
        safety_mode=safety_mode(raw),
        is_program_running=int(raw["runtime_state"]) == RUNTIME_PLAYING,
        tool_outputs=tool_outputs(raw),
        speed_scaling=float(np.clip(raw["speed_scaling"], 0.0, 1.0)),
        controller_s=float(raw["controller_s"]),
        time_s=float(raw["time_s"]),
        tool_force_n=float(raw["tool_force_n"]),
    )
