"""The controller's dashboard server: short questions and orders, one line each, on a socket of our own."""

from __future__ import annotations

import re
import socket
from threading import Lock

from hardware.errors import RobotLost
from hardware.robots.ur.probe import DASHBOARD_PORT

_ANSWER_S = 2.0
_NOT_KNOWN = "could not understand"


class Dashboard:
    """Safe from any thread; opened once and kept open, so that a stop does not wait for a connection."""

    def __init__(self, address: str) -> None:
        """Connect.

        Raises:
            RobotLost: nobody answers.
        """
        self._address = address
        self._lock = Lock()
        self._buffer = b""
        try:
            self._socket = socket.create_connection((address, DASHBOARD_PORT), _ANSWER_S)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._read_line(_ANSWER_S)  # the greeting
        except OSError as error:
            raise self._lost(error) from error

    def close(self) -> None:
        """Disconnect."""
        self._socket.close()

    def ask(self, line: str, within_s: float = _ANSWER_S) -> str:
        """Send a line and return the answer to it.

        Raises:
            RobotLost: no answer came in time; the connection is of no use any more.
        """
        if not self._lock.acquire(timeout=within_s):
            raise self._lost(TimeoutError("it is busy with another question"))
        try:
            self._socket.settimeout(within_s)
            self._socket.sendall(line.encode() + b"\n")
            return self._read_line(within_s)
        except OSError as error:
            # An answer that comes late would be taken for the answer to the next question.
            self._socket.close()
            raise self._lost(error) from error
        finally:
            self._lock.release()

    def stop(self, within_s: float) -> None:
        """End the program on the controller, and with it whatever moves.

        Raises:
            RobotLost: no answer came in time.
        """
        self.ask("stop", within_s)

    def is_in_local_control(self) -> bool:
        """Whether only the panel moves the arm; controllers before 5.6 know no such mode."""
        return self.ask("is in remote control").strip().lower() == "false"

    def robot_model(self) -> str | None:
        """The model it names itself, such as "UR5"; none where it does not know the question."""
        answer = self.ask("get robot model").strip()
        return None if _NOT_KNOWN in answer.lower() else answer

    def version(self) -> tuple[int, ...]:
        """The version of the controller's software: (3, 15) or more exact; empty if it tells none."""
        found = re.search(r"\d+(\.\d+)+", self.ask("PolyscopeVersion"))
        return tuple(int(part) for part in found[0].split(".")) if found else ()

    def _read_line(self, within_s: float) -> str:
        self._socket.settimeout(within_s)
        while b"\n" not in self._buffer:
            part = self._socket.recv(1024)
            if not part:
                raise ConnectionResetError("it closed the connection")
            self._buffer += part
        line, self._buffer = self._buffer.split(b"\n", 1)
        return line.decode("ascii", errors="replace")

    def _lost(self, error: OSError) -> RobotLost:
        return RobotLost(
            f"The dashboard of the controller at {self._address} does not answer ({error}); look at the arm, "
            "check the network cable, then recover the robot."
        )
