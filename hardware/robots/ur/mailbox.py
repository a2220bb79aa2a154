"""What the worker tells its parent at every cycle of the controller, and the memory that carries it."""

from __future__ import annotations

from multiprocessing.context import SpawnContext
from typing import Any

import numpy as np

from core.geometry import AnyArray
from hardware.modes import RobotMode, SafetyMode

RUNTIME_PLAYING = 2
"""The runtime state of a controller whose program runs; all others are on the way to or from a stop."""

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
    ]
)
"""One state; `tool_pose` is metres and a rotation vector, `time_s` is `time.monotonic`, which all processes
of a machine share, `progress` is the share of the present move."""

_COUNT_BYTES = 8


class StateMailbox:
    """Holds the newest state; one process writes, any number of threads read, nobody ever waits.

    The writer fills one of two places and then says which by a counter, so a writer that is killed or frozen
    at any moment leaves a whole state behind.
    """

    def __init__(self, context: SpawnContext) -> None:
        """Make it empty, in memory that a spawned process shares when it is handed over."""
        self._memory = context.RawArray("b", _COUNT_BYTES + 2 * FIELDS.itemsize)

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


def robot_mode(raw: AnyArray) -> RobotMode:
    """How far the arm is switched on; a number that nobody knows is not ready."""
    number = int(raw["robot_mode"])
    return RobotMode(number) if number in set(RobotMode) else RobotMode.NO_CONTROLLER


def safety_mode(raw: AnyArray) -> SafetyMode:
    """Whether the safety system lets the arm move; a number that nobody knows does not."""
    number = int(raw["safety_mode"])
    return SafetyMode(number) if number in set(SafetyMode) else SafetyMode.UNDEFINED
