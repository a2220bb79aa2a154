"""The controller in a process of its own, and the line to it.

Never in the client's process: ur_rtde's constructors hold the interpreter while they wait for answers.
"""

from __future__ import annotations

import socket
from collections.abc import Sequence
from multiprocessing.connection import Connection
from threading import Lock

from core.child_process import ChildProcess
from core.errors import PoursightError
from core.motion.factory_calibration import MeasuredKinematics
from hardware.errors import RobotError
from hardware.realtime import take_precedence
from hardware.simulation.ur_controller.identity import CONTROL_PORT, HOME_RAD, identity
from hardware.simulation.ur_controller.settings import ControllerSettings

_START_S = 15.0
_ANSWER_S = 5.0
_REFUSED = "error: "
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


class ControllerProcess:
    """A simulated UR controller; it runs while the context is open and dies with this process.

    Attributes:
        address: where its ports are, on loopback.
    """

    def __init__(
        self,
        model: str = "UR5",
        version: str = "3.15",
        address: str | None = None,
        joints_rad: Sequence[float] = HOME_RAD,
        speed_up: float = 1.0,
        faults: Sequence[str] = (),
        robotiq: str | None = None,
        measured: MeasuredKinematics | None = None,
    ) -> None:
        """Choose a controller; entering the context starts it.

        Args:
            model: "UR5" or "UR5e".
            version: of PolyScope; 3.x runs at 125 Hz, 5.x at 500 Hz.
            address: on loopback; without one, any 127.x.y.z that is free.
            joints_rad: (6,) where the arm is at first, powered on and with its brakes released.
            speed_up: how many times faster than the wall clock its clock, motion and cycles run.
            faults: lines as for `command`, taken at the start.
            robotiq: model of a Robotiq gripper that is served beside it; none: there is none.
            measured: the arm's own kinematics; none: they are as published.

        Raises:
            InputError: an unknown model, or a version that is none.
        """
        self.address = address or ""
        self._settings = ControllerSettings(
            identity(model, version), address, tuple(joints_rad), speed_up, tuple(faults), robotiq, measured
        )
        self._process: ChildProcess | None = None
        self._socket: socket.socket | None = None
        self._rest = b""
        self._lock = Lock()

    def __enter__(self) -> ControllerProcess:
        """Start it and wait until it listens.

        Raises:
            RobotError: it did not start; the sentence says why.
        """
        self._process = ChildProcess(_serve, self._settings, name="ur controller", environment=_ONE_THREAD)
        try:
            self.address = _address(self._process.connection)
            self._socket = socket.create_connection((self.address, CONTROL_PORT), _ANSWER_S)
        except OSError as error:
            self.kill()
            raise RobotError(f"The simulated controller cannot be reached ({error}).") from error
        except BaseException:
            self.kill()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        self.kill()

    @property
    def pid(self) -> int | None:
        """Of its process, while it runs."""
        return self._process.pid if self._process is not None else None

    def command(self, line: str) -> str:
        """Send one line to the control socket and return the one line that it answers.

        Faults are put in and the state is read this way; the module `faults` lists the lines.

        Raises:
            RobotError: the controller refused the line, or is not there.
        """
        with self._lock:
            if self._socket is None:
                raise RobotError("The simulated controller does not run; enter its context first.")
            try:
                self._socket.sendall(line.encode() + b"\n")
                answer = self._receive_line()
            except OSError as error:
                raise RobotError(f"The simulated controller does not answer ({error}).") from error
        if answer.startswith(_REFUSED):
            raise RobotError(f"The simulated controller refused '{line}': {answer[len(_REFUSED) :]}.")
        return answer

    def kill(self) -> None:
        """End the process at once, as if the controller's power had failed; may be called twice."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
        if self._process is not None:
            self._process.end()
            self._process = None

    def _receive_line(self) -> str:
        assert self._socket is not None
        while b"\n" not in self._rest:
            data = self._socket.recv(1 << 16)
            if not data:
                raise ConnectionResetError("it has closed the connection")
            self._rest += data
        line, _, self._rest = self._rest.partition(b"\n")
        return line.decode()


def _serve(connection: Connection, settings: ControllerSettings) -> None:
    """In the new process: send the address once everything listens, or why nothing does."""
    import asyncio  # here: the window starts controllers, and is none

    from hardware.simulation.ur_controller.server import ControllerServer

    take_precedence()  # a controller is a computer of its own: what else runs here must not slow it down
    try:
        asyncio.run(ControllerServer(settings).run(connection.send))
    except PoursightError as error:
        connection.send(error)


def _address(connection: Connection) -> str:
    """What the new process sends first."""
    try:
        answer = connection.recv() if connection.poll(_START_S) else None
    except EOFError:
        answer = None
    if not isinstance(answer, str):
        raise RobotError("The simulated controller did not start." if answer is None else str(answer))
    return answer
