"""Small scripts that run beside nothing else, sent as text; nothing is answered."""

from __future__ import annotations

import socket

from hardware.errors import RobotLost
from hardware.robots.ur.probe import SCRIPT_PORT

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
