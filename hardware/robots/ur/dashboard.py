"""The controller's dashboard server, on a socket of our own, and what is done through it."""

from __future__ import annotations

import re
import socket
import time
from collections.abc import Callable
from threading import Lock

from hardware.errors import EmergencyStop, ProtectiveStop, RobotLost, RobotNotReady
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.probe import DASHBOARD_PORT

_CONNECT_S = 2.0
_ANSWER_S = 8.0
"""A panel that is busy answers late; whoever stops the arm waits for no such answer."""
_ENDS_WITHIN_S = 2.0
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
            self._socket = socket.create_connection((address, DASHBOARD_PORT), _CONNECT_S)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._read_line(_CONNECT_S)  # the greeting
        except OSError as error:
            raise self._lost(error) from error

    def __enter__(self) -> Dashboard:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

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

    def program(self) -> str | None:
        """What the program on the controller does and how it is called, such as "PLAYING weld.urp".

        None when there is none under way, or the question is not known.
        """
        answer = self.ask("programState").strip()
        return answer if answer.upper().startswith(("PLAYING", "PAUSED")) else None

    def end_program(self) -> None:
        """End the program on the controller.

        Raises:
            RobotNotReady: it goes on.
        """
        self.ask("stop")
        if not _comes_true(lambda: self.program() is None, _ENDS_WITHIN_S):
            raise RobotNotReady(
                f"The program on the controller at {self._address} does not end; end it at its panel."
            )

    def is_in_local_control(self) -> bool:
        """Whether only the panel moves the arm; controllers before 5.6 know no such mode."""
        return self.ask("is in remote control").strip().lower() == "false"

    def robot_model(self) -> str | None:
        """The model it names itself, such as "UR5"; none where it does not know the question."""
        answer = self.ask("get robot model").strip()
        return None if _NOT_KNOWN in answer.lower() else answer

    def serial_number(self) -> str | None:
        """The arm's serial number; none where it does not know the question."""
        answer = self.ask("get serial number").strip()
        return answer if re.fullmatch(r"[\w-]{4,30}", answer) else None

    def has_remote_control(self) -> bool:
        """Whether it tells local from remote control: controllers before 5.6 do not."""
        return self.ask("is in remote control").strip().lower() in ("true", "false")

    def version(self) -> tuple[int, ...]:
        """The version of the controller's software: (3, 15) or more exact; empty if it reports none."""
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


_UNLOCK_WITHIN_S = 8.0
"""The controller unlocks a protective stop 5 s after it, so that somebody looks first."""
_SWITCH_WITHIN_S = 30.0
_RESTART_WITHIN_S = 30.0
_POLL_S = 0.1


def make_ready(dashboard: Dashboard, name: str) -> None:
    """End the program, unlock a protective stop, switch on power and release the brakes.

    The program is ended first: a paused one would go on with its old move once it is played again.

    Raises:
        RobotError: a person has to do something first; the sentence says what.
    """
    dashboard.ask("stop")
    dashboard.ask("close popup")
    dashboard.ask("close safety popup")
    _refuse_emergency(_safety(dashboard), name)
    if _safety(dashboard) is SafetyMode.PROTECTIVE_STOP:
        unlock(dashboard, name)
    if not _safety(dashboard).may_move:
        raise RobotNotReady(
            f"The safety system of the {name} is in '{_safety(dashboard).words}'; clear that at its "
            "panel, then recover the robot again."
        )
    if _mode(dashboard) is not RobotMode.RUNNING:
        switch_on(dashboard, name)


def _refuse_emergency(safety: SafetyMode, name: str) -> None:
    if safety.is_emergency:
        raise EmergencyStop(
            f"The emergency stop of the {name} is pressed; see that all is safe, release it, then recover "
            "the robot again."
        )


def unlock(dashboard: Dashboard, name: str) -> None:
    """Unlock a protective stop, when its time has come.

    Raises:
        ProtectiveStop: it stays.
    """

    def is_unlocked() -> bool:
        dashboard.ask("unlock protective stop")
        return _safety(dashboard) is not SafetyMode.PROTECTIVE_STOP

    if not _comes_true(is_unlocked, _UNLOCK_WITHIN_S):
        raise ProtectiveStop(
            f"The protective stop of the {name} does not unlock; see what the arm touches and unlock it at "
            "the panel, then recover the robot again."
        )


def restart_safety(dashboard: Dashboard, name: str) -> None:
    """Start the safety system again after a fault or a violation; the arm's power is off then.

    Raises:
        RobotNotReady: the fault stays.
    """
    dashboard.ask("close safety popup")
    dashboard.ask("restart safety")
    if not _comes_true(lambda: _safety(dashboard).may_move, _RESTART_WITHIN_S):
        raise RobotNotReady(
            f"The safety system of the {name} stays in '{_safety(dashboard).words}'; clear that at its panel."
        )


def switch_on(dashboard: Dashboard, name: str, has_brakes_released: bool = True) -> None:
    """Switch the arm's power on, and release its brakes unless they shall stay.

    Raises:
        RobotNotReady: it does not come on.
    """
    dashboard.ask("power on")
    is_fine = _comes_true(lambda: _mode(dashboard) in (RobotMode.IDLE, RobotMode.RUNNING), _SWITCH_WITHIN_S)
    if has_brakes_released:
        dashboard.ask("brake release")
        is_fine = is_fine and _comes_true(lambda: _mode(dashboard) is RobotMode.RUNNING, _SWITCH_WITHIN_S)
    if not is_fine:
        raise RobotNotReady(
            f"The {name} does not switch on: it stays in '{_mode(dashboard).words}'; switch it on at its "
            "panel, then recover the robot again."
        )


def _safety(dashboard: Dashboard) -> SafetyMode:
    said = dashboard.ask("safetymode").partition(":")[2].strip()
    return SafetyMode.__members__.get(said, SafetyMode.UNDEFINED)


def _mode(dashboard: Dashboard) -> RobotMode:
    said = dashboard.ask("robotmode").partition(":")[2].strip()
    return RobotMode.__members__.get(said, RobotMode.NO_CONTROLLER)


def _comes_true(is_so: Callable[[], bool], within_s: float) -> bool:
    deadline_s = time.monotonic() + within_s
    while not is_so():
        if time.monotonic() > deadline_s:
            return False
        time.sleep(_POLL_S)
    return True
