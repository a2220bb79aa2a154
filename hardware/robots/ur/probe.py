"""The controller's ports beside ur_rtde: is a UR controller there, and what is set by a small script."""

from __future__ import annotations

import socket
import struct
import time

from hardware.errors import RobotLost, RobotUnreachable

DASHBOARD_PORT = 29999
SCRIPT_PORT = 30003
DATA_PORT = 30004
UR_GREETING = "Universal Robots"
PROBE_S = 3.0
"""For all ports together."""

_PURPOSES = {DASHBOARD_PORT: "dashboard", SCRIPT_PORT: "script", DATA_PORT: "data (RTDE)"}
_ASK_PROTOCOL_2 = struct.pack(">HBH", 5, ord("V"), 2)
_ACCEPTS_PROTOCOL_2 = struct.pack(">HBB", 4, ord("V"), 1)


def probe(address: str) -> None:
    """Check that a UR controller answers on each of its ports.

    Raises:
        RobotUnreachable: nobody answers, or somebody else, within `PROBE_S`.
    """
    deadline_s = time.monotonic() + PROBE_S
    for port, purpose in _PURPOSES.items():
        try:
            with socket.create_connection((address, port), _left_s(deadline_s)) as connection:
                is_controller, received = _answers_as_controller(connection, port, deadline_s)
        except (OSError, UnicodeError) as error:  # a name that is none fails in its encoding
            raise RobotUnreachable(
                f"Nobody answers at {address} on its {purpose} port {port} ({error}); switch the controller "
                "on, check the address in the cell file and the network cable."
            ) from error
        if not is_controller:
            says = (
                "is no UR controller; correct the address in the cell file."
                if received
                else "sends nothing: a controller that hangs or is still starting does so; see its panel and "
                "restart it, or correct the address in the cell file if there is no UR controller."
            )
            raise RobotUnreachable(f"What answers at {address} on port {port} {says}")


def _answers_as_controller(connection: socket.socket, port: int, deadline_s: float) -> tuple[bool, bytes]:
    """Whether it does, and what it said."""
    received = b""
    if port == DASHBOARD_PORT:
        received = _receive(connection, len(UR_GREETING), deadline_s)
        return UR_GREETING.encode() in received, received
    if port == DATA_PORT:
        connection.sendall(_ASK_PROTOCOL_2)
        received = _receive(connection, len(_ACCEPTS_PROTOCOL_2), deadline_s)
        return received == _ACCEPTS_PROTOCOL_2, received
    return True, received


def _receive(connection: socket.socket, at_least: int, deadline_s: float) -> bytes:
    """What comes until the deadline; empty or short when nothing does."""
    received = b""
    while len(received) < at_least:
        connection.settimeout(_left_s(deadline_s))
        try:
            part = connection.recv(200)
        except OSError:
            break
        if not part:
            break
        received += part
    return received


def _left_s(deadline_s: float) -> float:
    return max(deadline_s - time.monotonic(), 0.05)


_SEND_S = 2.0


def set_tool_voltage(address: str, voltage_v: int) -> None:
    """Set the supply of the tool connector (0, 12 or 24 V) by a secondary program (URScript manual, `sec`).

    It has to be sent before the control program starts: whether the controller keeps that one running beside
    it was never tried on an arm. ur_rtde 1.6.5 neither sets nor reads this voltage, so it is not verified;
    the robot's panel shows it under I/O.

    Raises:
        RobotLost: the script could not be sent.
    """
    script = f"sec poursight_tool_voltage():\n  set_tool_voltage({voltage_v})\nend\n"
    try:
        with socket.create_connection((address, SCRIPT_PORT), _SEND_S) as connection:
            connection.sendall(script.encode())
    except OSError as error:
        raise RobotLost(
            f"The script port of the controller at {address} takes nothing ({error}); check the network "
            "cable, then recover the robot."
        ) from error
