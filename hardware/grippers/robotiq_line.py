"""The line to a Robotiq gripper: the text protocol of the program that serves it on the arm's controller.

Source: Robotiq, "2F-85 & 2F-140 Instruction Manual" and "Hand-E Instruction Manual", section "Control": the
registers and their values; the URCap serves them on a port as lines: `GET POS` is answered with `POS 12`,
`SET ACT 1 GTO 1` with `ack`, without an end of line there.
"""

from __future__ import annotations

import re
import socket
import time
from dataclasses import dataclass
from enum import IntEnum
from threading import Lock

from hardware.errors import GripperError

ROBOTIQ_PORT = 63352
ACTIVE = 3
"""The status (STA) of a gripper that takes commands."""
HIGHEST = 255
_WITHIN_S = 0.3
_CONNECT_S = 2.0
_REST_S = 0.02
"""An answer whose end does not show is whole when no more of it comes."""
_LONGEST = 200


class Contact(IntEnum):
    """What the fingers met (OBJ)."""

    MOVING = 0
    WHILE_OPENING = 1
    WHILE_CLOSING = 2
    NONE = 3


@dataclass(frozen=True)
class RobotiqAddress:
    """Where a gripper is served: the controller's address or another one, and the port."""

    host: str
    port: int = ROBOTIQ_PORT

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


class RobotiqLine:
    """Asks and tells; safe from any thread. An answer that is late or wrong ends the connection."""

    def __init__(self, address: RobotiqAddress, within_s: float = _WITHIN_S) -> None:
        """Connect.

        Args:
            address: where it is served.
            within_s: how long each answer may take.

        Raises:
            GripperError: nobody answers there.
        """
        self._address = address
        self._within_s = within_s
        self._lock = Lock()
        try:
            self._socket = socket.create_connection((address.host, address.port), _CONNECT_S)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        except OSError as error:
            raise GripperError(
                f"Nobody serves a Robotiq gripper at {address} ({error}); see that its URCap is installed on "
                "the controller, and its address in the cell file."
            ) from error

    def __enter__(self) -> RobotiqLine:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    @property
    def is_closed(self) -> bool:
        """Whether the connection is no more."""
        return self._socket.fileno() < 0

    def close(self) -> None:
        """Disconnect; the gripper stays as it is."""
        self._socket.close()

    def get(self, name: str) -> int:
        """Return what a register holds, 0 to 255.

        Raises:
            GripperError: no answer comes in time, or another one.
        """
        answer = self._ask(f"GET {name}")
        found = re.fullmatch(rf"{name} (\d{{1,3}})", answer)
        if found is None or int(found[1]) > HIGHEST:
            raise self._wrong(f"GET {name}", answer)
        return int(found[1])

    def set(self, **registers: int) -> None:
        """Write registers, in this order.

        Raises:
            GripperError: it is not acknowledged in time.
        """
        line = " ".join(["SET", *(f"{name} {value}" for name, value in registers.items())])
        answer = self._ask(line)
        if answer != "ack":
            raise self._wrong(line, answer)

    def _ask(self, line: str) -> str:
        with self._lock:
            try:
                self._socket.settimeout(self._within_s)
                self._socket.sendall(line.encode() + b"\n")
                return self._receive()
            except OSError as error:
                # A late answer would be taken for the one to the next question.
                self._socket.close()
                raise GripperError(
                    f"The Robotiq gripper at {self._address} does not answer to '{line}' ({error}); look at "
                    "the cup, its cable and its URCap, then recover the robot."
                ) from error

    def _receive(self) -> str:
        deadline_s = time.monotonic() + self._within_s
        received = b""
        while len(received) < _LONGEST:
            try:
                part = self._socket.recv(_LONGEST)
            except TimeoutError:
                if received:
                    break
                raise
            if not part:
                raise ConnectionResetError("it closed the connection")
            received += part
            if received.endswith(b"\n") or received == b"ack":
                break
            self._socket.settimeout(max(min(_REST_S, deadline_s - time.monotonic()), 1e-3))
        return received.decode("ascii", errors="replace").strip()

    def _wrong(self, line: str, answer: str) -> GripperError:
        with self._lock:
            self._socket.close()
        return GripperError(
            f"What answers at {self._address} to '{line}' is no Robotiq gripper ('{answer[:40]}'); correct "
            "the address and port in the cell file, or restart the URCap."
        )


def refuse_faulty(line: RobotiqLine, address: RobotiqAddress) -> None:
    """Refuse a gripper that reports a fault of its own or is not activated.

    Raises:
        GripperError: it does.
    """
    fault = line.get("FLT") & 0x0F  # the higher half is the controller's own
    if fault in _FAULTS:
        raise GripperError(
            f"The Robotiq gripper at {address} reports a fault (0x{fault:02X}: {_FAULTS[fault]}); see to it "
            "at the panel, empty the hand and activate the gripper anew."
        )
    if line.get("STA") != ACTIVE:
        raise GripperError(
            f"The Robotiq gripper at {address} is not activated; empty the hand, for its fingers move then, "
            "and activate it."
        )


_FAULTS = {
    0x08: "too hot",
    0x09: "no communication with its controller",
    0x0A: "too little voltage",
    0x0B: "an automatic release is under way",
    0x0C: "an internal fault",
    0x0D: "the activation failed",
    0x0E: "too much current",
    0x0F: "an automatic release has been made",
}
"""What the gripper's manual calls minor and major faults; 5 and 7 ask for the activation, which STA tells."""

_ACTIVATED_WITHIN_S = 10.0
_POLL_S = 0.05


def activate(address: RobotiqAddress) -> None:
    """Activate a gripper: its fingers open and close once. It takes some seconds.

    Raises:
        GripperError: it does not become active, or reports a fault.
    """
    with RobotiqLine(address) as line:
        line.set(ACT=0)
        line.set(ACT=1)
        deadline_s = time.monotonic() + _ACTIVATED_WITHIN_S
        while line.get("STA") != ACTIVE and time.monotonic() < deadline_s:
            time.sleep(_POLL_S)
        refuse_faulty(line, address)


def holds_object(address: RobotiqAddress) -> bool:
    """Whether an activated gripper has closed around something.

    Raises:
        GripperError: it does not answer.
    """
    with RobotiqLine(address) as line:
        return line.get("STA") == ACTIVE and line.get("OBJ") == Contact.WHILE_CLOSING


def is_activated(address: RobotiqAddress) -> bool:
    """Whether it takes commands.

    Raises:
        GripperError: it does not answer.
    """
    with RobotiqLine(address) as line:
        return line.get("STA") == ACTIVE
