"""A look at a controller that writes nothing: one state over its data interface (RTDE).

Source: Universal Robots, article 22229 "Real-Time Data Exchange (RTDE) Guide".
"""

from __future__ import annotations

import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType

from hardware.errors import RobotLost
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.messages import known_robot_mode, known_safety_mode
from hardware.robots.ur.probe import DATA_PORT

_WITHIN_S = 2.0
_TYPES = MappingProxyType({"DOUBLE": "d", "VECTOR6D": "6d", "INT32": "i", "UINT32": "I", "UINT64": "Q"})
_FIELDS = (
    "actual_q",
    "actual_qd",
    "actual_TCP_pose",
    "robot_mode",
    "safety_mode",
    "runtime_state",
    "actual_digital_output_bits",
    "target_speed_fraction",
    "tool_output_voltage",
    "tool_output_mode",
    "tcp_offset",
)
_NOT_FOUND = "NOT_FOUND"
_COMMAND_REGISTER = "input_int_register_0"
_MOVING_RAD_S = 0.01
_OUTPUT_BITS = {0: 16, 1: 17}


@dataclass(frozen=True)
class Glance:
    """One state of a controller; what an old one does not know is none.

    Attributes:
        joints_rad: (6) where the joints are.
        joint_speeds_rad_s: (6) how fast they rotate.
        tool_pose: (6) of the tool: metres and a rotation vector.
        robot_mode: how far the arm is switched on.
        safety_mode: whether the safety system lets it move.
        runtime_state: of its program; 2: it runs.
        tool_outputs: the two digital outputs of the tool.
        slider: share of the programmed speed, 0 to 1.
        tool_voltage_v: supply of the tool connector.
        tool_offset: (6) of the tool frame at the flange, as set now.
        has_dual_pin_power: whether the tool's outputs are set to be a power supply (e-Series).
        has_free_inputs: whether no other client holds the registers through which programs are driven.
    """

    joints_rad: tuple[float, ...]
    joint_speeds_rad_s: tuple[float, ...]
    tool_pose: tuple[float, ...]
    robot_mode: RobotMode
    safety_mode: SafetyMode
    runtime_state: int
    tool_outputs: tuple[bool, bool]
    slider: float
    tool_voltage_v: int | None
    tool_offset: tuple[float, ...] | None
    has_dual_pin_power: bool
    has_free_inputs: bool

    @property
    def is_moving(self) -> bool:
        """Whether a joint rotates."""
        return max(map(abs, self.joint_speeds_rad_s)) > _MOVING_RAD_S


def glance(address: str) -> Glance:
    """Look at a controller; nothing is set on it.

    Raises:
        RobotLost: it does not answer, or not as the protocol says.
    """
    try:
        with _connected(address) as line:
            values = _read_fields(line)
        with _connected(address) as line:
            has_free_inputs = _are_free(line)
    except (OSError, struct.error, UnicodeDecodeError) as error:
        raise RobotLost(
            f"The data interface of the controller at {address} does not answer ({error}); look at the arm, "
            "check the network cable, then recover the robot."
        ) from error
    bits = int(values["actual_digital_output_bits"][0])
    voltage, offset = values.get("tool_output_voltage"), values.get("tcp_offset")
    return Glance(
        values["actual_q"],
        values["actual_qd"],
        values["actual_TCP_pose"],
        known_robot_mode(int(values["robot_mode"][0])),
        known_safety_mode(int(values["safety_mode"][0])),
        int(values["runtime_state"][0]),
        (bool(bits >> _OUTPUT_BITS[0] & 1), bool(bits >> _OUTPUT_BITS[1] & 1)),
        float(values["target_speed_fraction"][0]),
        None if voltage is None else int(voltage[0]),
        offset,
        bool(values.get("tool_output_mode", (0,))[0]),
        has_free_inputs,
    )


@contextmanager
def _connected(address: str) -> Iterator[socket.socket]:
    with socket.create_connection((address, DATA_PORT), _WITHIN_S) as line:
        line.settimeout(_WITHIN_S)
        _send(line, "V", struct.pack(">H", 2))
        if _answer(line, "V") != b"\x01":
            raise ConnectionError("it does not speak version 2 of the protocol")
        yield line


def _read_fields(line: socket.socket) -> dict[str, tuple[float, ...]]:
    names: tuple[str, ...] = _FIELDS
    types = _set_up(line, names)
    if _NOT_FOUND in types:
        names = tuple(name for name, kind in zip(names, types, strict=True) if kind != _NOT_FOUND)
        types = _set_up(line, names)
    _send(line, "S")
    if _answer(line, "S") != b"\x01":
        raise ConnectionError("it does not start to send")
    rest = _answer(line, "U")[1:]
    values = {}
    for name, kind in zip(names, types, strict=True):
        part = struct.Struct(">" + _TYPES[kind])
        values[name], rest = part.unpack_from(rest), rest[part.size :]
    return values


def _set_up(line: socket.socket, names: tuple[str, ...]) -> list[str]:
    """Ask for fields, ten times a second; return their types."""
    _send(line, "O", struct.pack(">d", 10.0) + ",".join(names).encode())
    return _answer(line, "O")[1:].decode("ascii").split(",")


def _are_free(line: socket.socket) -> bool:
    """Whether the register that takes commands could be had; it is given back with the connection."""
    _send(line, "I", _COMMAND_REGISTER.encode())
    return b"IN_USE" not in _answer(line, "I")


def _send(line: socket.socket, kind: str, payload: bytes = b"") -> None:
    line.sendall(struct.pack(">HB", 3 + len(payload), ord(kind)) + payload)


def _answer(line: socket.socket, kind: str) -> bytes:
    """The payload of the next frame of a kind."""
    while True:
        size, found = struct.unpack(">HB", _exactly(line, 3))
        payload = _exactly(line, size - 3)
        if found == ord(kind):
            return payload


def _exactly(line: socket.socket, n: int) -> bytes:
    received = b""
    while len(received) < n:
        part = line.recv(n - len(received))
        if not part:
            raise ConnectionResetError("it closed the connection")
        received += part
    return received
