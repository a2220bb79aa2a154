"""The controller in a process of its own, and the line to it.

Never in the client's process: ur_rtde's constructors hold the interpreter while they wait for answers.
"""

from __future__ import annotations

import json
import os
import select
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from threading import Lock

from hardware.errors import RobotError
from hardware.simulation.ur_controller.addresses import CONTROL_PORT, HOME_RAD

_ROOT = Path(__file__).resolve().parents[3]
_START_S = 15.0
_ANSWER_S = 5.0
_REFUSED = "error: "


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
    ) -> None:
        """Choose a controller; entering the context starts it.

        Args:
            model: "UR5" or "UR5e".
            version: of PolyScope; 3.x runs at 125 Hz, 5.x at 500 Hz.
            address: on loopback; without one, any 127.x.y.z that is free.
            joints_rad: (6,) where the arm stands at first, powered on and with its brakes released.
            speed_up: how many times faster than the wall clock its clock, motion and cycles run.
            faults: lines as for `command`, taken at the start.
        """
        self.address = address or ""
        self._wish = {
            "model": model,
            "version": version,
            "address": address,
            "joints_rad": [float(angle) for angle in joints_rad],
            "speed_up": speed_up,
            "faults": list(faults),
        }
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None
        self._rest = b""
        self._lock = Lock()

    def __enter__(self) -> ControllerProcess:
        """Start it and wait until it listens.

        Raises:
            RobotError: it did not start; the sentence says why.
        """
        paths = os.pathsep.join([str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
        self._process = subprocess.Popen(
            [sys.executable, "-m", __package__, json.dumps(self._wish)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )
        try:
            word, _, rest = self._first_line().partition(" ")
            if word != "listens":
                raise RobotError(rest or "The simulated controller did not start.")
            self.address = rest
            self._socket = socket.create_connection((self.address, CONTROL_PORT), _ANSWER_S)
        except (OSError, RobotError) as error:
            self.kill()
            if isinstance(error, RobotError):
                raise
            raise RobotError(f"The simulated controller cannot be reached ({error}).") from error
        return self

    def __exit__(self, *exception: object) -> None:
        self.kill()

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
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _first_line(self) -> str:
        assert self._process is not None and self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], _START_S)
        return self._process.stdout.readline().decode().strip() if ready else ""

    def _receive_line(self) -> str:
        assert self._socket is not None
        while b"\n" not in self._rest:
            data = self._socket.recv(1 << 16)
            if not data:
                raise ConnectionResetError("it has closed the connection")
            self._rest += data
        line, _, self._rest = self._rest.partition(b"\n")
        return line.decode()
