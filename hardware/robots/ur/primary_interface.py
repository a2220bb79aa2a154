"""What a controller tells of its arm, over its primary interface: its own kinematics, and its joints' limits.

Source: Universal Robots, "Overview of client interfaces" and their client library: big-endian packages of an
int32 length, which counts all of it, and a uint8 type; the parts of a robot state have such a header, too.
"""

from __future__ import annotations

import math
import socket
import struct
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from core.motion.arm_models import JointValues
from core.motion.factory_calibration import MeasuredKinematics

PRIMARY_PORT = 30001
ROBOT_STATE = 16
KINEMATICS_INFO = 5
CONFIGURATION_DATA = 6
HEADER = struct.Struct(">iB")
KINEMATICS = struct.Struct(">6I6d6d6d6dI")
"""Checksums, theta, a, d, alpha, and a status whose values are not documented."""
CONFIGURATION = struct.Struct(">24d5d24d4i")
"""Each joint's lowest and highest angle, then its highest speed and acceleration; the defaults of moves, an
equivalent radius, Denavit-Hartenberg parameters, and four types. Newer versions append more."""
_WITHIN_S = 1.0
_LONGEST = 1 << 16
"""Of a package; a robot state has about 1,400 bytes."""


class DamagedPackage(Exception):
    """The bytes are no packages of this protocol; the text says what is wrong with them."""


T = TypeVar("T")


def receive_kinematics(address: str) -> MeasuredKinematics:
    """Wait for a robot state that holds the kinematics; raises as `_receive` does."""
    return _receive(address, kinematics_of, "kinematics")


def receive_configuration(address: str) -> tuple[float, ...]:
    """Wait for a robot state that holds configuration data, the numbers of `CONFIGURATION`.

    Raises as `_receive` does.
    """
    return _receive(address, configuration_of, "configuration data")


def _receive(address: str, find: Callable[[bytes], T | None], what: str) -> T:
    """Wait for a robot state in which something is found, for `_WITHIN_S` in all; nothing is written.

    Raises:
        OSError: nobody answers, or the connection is closed or silent.
        DamagedPackage: what comes is not as the protocol says.
    """
    deadline_s = time.monotonic() + _WITHIN_S
    received = b""
    with socket.create_connection((address, PRIMARY_PORT), _WITHIN_S) as line:
        while True:
            while (package := next_package(received)) is not None:
                kind, content, received = package
                found = find(content) if kind == ROBOT_STATE else None
                if found is not None:
                    return found
            line.settimeout(_left_s(deadline_s, what))
            part = line.recv(1 << 14)
            if not part:
                raise ConnectionResetError("it closed the connection")
            received += part


def next_package(received: bytes) -> tuple[int, bytes, bytes] | None:
    """Return the first package's type and content, and what follows it; none as long as it is not whole.

    Raises:
        DamagedPackage: no package has this length.
    """
    if len(received) < HEADER.size:
        return None
    size, kind = HEADER.unpack_from(received)
    if not HEADER.size <= size <= _LONGEST:
        raise DamagedPackage(f"it announces a package of {size} bytes")
    if len(received) < size:
        return None
    return kind, received[HEADER.size : size], received[size:]


def kinematics_of(robot_state: bytes) -> MeasuredKinematics | None:
    """Return the kinematics that a robot state's content holds; none if it holds none.

    Raises:
        DamagedPackage: a sub-package is cut off, or a number is none.
    """
    for kind, content in _parts(robot_state):
        if kind == KINEMATICS_INFO:
            return _kinematics(content)
    return None


def configuration_of(robot_state: bytes) -> tuple[float, ...] | None:
    """Return the configuration data that a robot state's content holds; none if it holds none.

    Raises:
        DamagedPackage: a sub-package is cut off.
    """
    for kind, content in _parts(robot_state):
        if kind == CONFIGURATION_DATA:
            if len(content) < CONFIGURATION.size:
                raise DamagedPackage("its configuration data are cut off")
            return CONFIGURATION.unpack_from(content)
    return None


def _parts(robot_state: bytes) -> Iterator[tuple[int, bytes]]:
    """Type and content of each part of a robot state's content."""
    rest = robot_state
    while rest:
        package = next_package(rest)
        if package is None:
            raise DamagedPackage("a part of its state is cut off")
        kind, content, rest = package
        yield kind, content


def _kinematics(content: bytes) -> MeasuredKinematics:
    if len(content) < KINEMATICS.size:
        raise DamagedPackage("its kinematics are cut off")
    values = KINEMATICS.unpack_from(content)
    theta, a, d, alpha = (_joint_values(values[first : first + 6]) for first in (6, 12, 18, 24))
    return MeasuredKinematics(theta, a, d, alpha, values[:6])


def _joint_values(values: tuple[float, ...]) -> JointValues:
    if not all(math.isfinite(value) for value in values):
        raise DamagedPackage("its kinematics hold what is no number")
    base, shoulder, elbow, wrist_1, wrist_2, wrist_3 = values
    return base, shoulder, elbow, wrist_1, wrist_2, wrist_3


def _left_s(deadline_s: float, what: str) -> float:
    left_s = deadline_s - time.monotonic()
    if left_s <= 0:
        raise TimeoutError(f"it sends no {what}")
    return left_s
