"""A connection to the controller for STOP alone, kept open beside whatever else talks to it."""

from __future__ import annotations

import socket
import time
from contextlib import suppress
from threading import Event, Thread

from hardware.errors import RobotError, RobotLost
from hardware.robots.ur.probe import DASHBOARD_PORT, UR_GREETING

ANSWER_S = 0.25
"""A line that has not answered after this time is given up, and another one is opened."""
_DIAL_S = 0.5
_AGAIN_S = 1.0
_REFUSED = "not allowed"


class StopLine:
    """Ends the program on a controller, and with it what moves, by its dashboard server.

    It needs neither the driver's process nor the one that carries out a pour. A thread holds the connection
    open and opens it anew when it breaks, so that a stop has not to wait for one. It is a software stop and
    no substitute for the emergency stop at the arm's panel.
    """

    def __init__(self, address: str) -> None:
        """Return at once; the connection comes when the controller answers."""
        self._address = address
        self._socket: socket.socket | None = None
        self._is_closed = Event()
        self._has_answered = Event()
        self._answer = ""
        self._thread = Thread(target=self._keep_open, name="stop line", daemon=True)
        self._thread.start()

    @property
    def is_open(self) -> bool:
        """Whether there is a connection now; a stop works without one, but takes longer."""
        return self._socket is not None

    def stop(self) -> None:
        """Stop; returns when the controller says that it did. May be called from any thread.

        Raises:
            RobotLost: the controller cannot be reached.
            RobotError: it refuses.
        """
        answer = self._by_open_line() or self._by_new_line()
        if _REFUSED in answer.lower():
            raise RobotError(
                f"The controller at {self._address} refuses to stop ({answer}); press the emergency stop if "
                "the arm moves."
            )

    def close(self) -> None:
        """Disconnect; returns at once."""
        self._is_closed.set()
        _hang_up(self._socket)

    def _by_open_line(self) -> str:
        """The answer to a stop; empty if there is no connection, or none that answers in time."""
        line = self._socket
        if line is None:
            return ""
        self._has_answered.clear()
        try:
            line.sendall(b"stop\n")
        except OSError:
            return ""
        if self._has_answered.wait(ANSWER_S):
            return self._answer
        _hang_up(line)  # the thread opens another
        return ""

    def _by_new_line(self) -> str:
        try:
            with _dial(self._address) as line:
                line.sendall(b"stop\n")
                return _receive_line(line)
        except OSError as error:
            raise RobotLost(
                f"The controller at {self._address} cannot be reached for a stop ({error}); press the "
                "emergency stop if the arm moves."
            ) from error

    def _keep_open(self) -> None:
        while not self._is_closed.is_set():
            with suppress(OSError), _dial(self._address) as line:
                line.settimeout(None)
                self._socket = line
                if not self._is_closed.is_set():
                    self._listen(line)
            self._socket = None
            self._is_closed.wait(_AGAIN_S)

    def _listen(self, line: socket.socket) -> None:
        """Note every answer until the line breaks; nothing but stops is ever sent."""
        while True:
            self._answer = _receive_line(line)
            self._has_answered.set()


def _dial(address: str) -> socket.socket:
    """Connect and hear the greeting.

    Raises:
        OSError: nobody answers in time, or somebody else does.
    """
    deadline_s = time.monotonic() + _DIAL_S
    line = socket.create_connection((address, DASHBOARD_PORT), _DIAL_S)
    try:
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _notice_a_dead_peer(line)
        line.settimeout(max(deadline_s - time.monotonic(), 0.01))
        greeting = _receive_line(line)
        if UR_GREETING not in greeting:
            raise ConnectionError(f"'{greeting}' is no greeting of a controller")
    except OSError:
        line.close()
        raise
    line.settimeout(_DIAL_S)
    return line


def _notice_a_dead_peer(line: socket.socket) -> None:
    """Let the system ask every two seconds whether the other end is still there."""
    line.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in (("TCP_KEEPIDLE", 2), ("TCP_KEEPINTVL", 1), ("TCP_KEEPCNT", 2)):
        if hasattr(socket, name):
            line.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _receive_line(line: socket.socket) -> str:
    """One line; byte by byte, so that nothing of the next one is taken.

    Raises:
        OSError: it does not come.
    """
    received = b""
    while not received.endswith(b"\n"):
        part = line.recv(1)
        if not part:
            raise ConnectionResetError("it closed the connection")
        received += part
    return received.decode("ascii", errors="replace").strip()


def _hang_up(line: socket.socket | None) -> None:
    """Break a connection on which another thread waits."""
    if line is not None:
        with suppress(OSError):
            line.shutdown(socket.SHUT_RDWR)
