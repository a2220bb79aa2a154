"""A controller without sockets, whose cycles a test plays itself: quick, and the same every time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hardware.simulation.ur_controller.controller import Controller
from hardware.simulation.ur_controller.identity import HOME_RAD, identity
from hardware.simulation.ur_controller.registers import COMMAND_REGISTER

SCRIPT = "def rtde_control():\nend\n"
READY, DONE = 1, 2


class Desk:
    """Writes commands as ur_rtde does."""

    def __init__(self, version: str = "3.15", model: str = "UR5", script: str = SCRIPT) -> None:
        self.controller = Controller(identity(model, version), HOME_RAD)
        self.controller.upload(script)
        self.run(0.02)

    @property
    def answer(self) -> int:
        return self.controller.registers.ints[0]

    def run(self, time_s: float) -> None:
        for _ in range(round(time_s / self.controller.dt_s)):
            self.controller.step()

    def run_until(self, is_so: Callable[[], bool], limit_s: float = 20.0) -> float:
        """Return how long it took by the controller's clock."""
        begin_s = self.controller.time_s
        while not is_so():
            assert self.controller.time_s - begin_s < limit_s, "it did not come to it"
            self.controller.step()
        return self.controller.time_s - begin_s

    def write(self, code: int, arguments: Sequence[float] = (), is_async: bool = False) -> None:
        registers = self.controller.registers
        for k, value in enumerate(arguments):
            registers.write(f"input_double_register_{k}", float(value))
        registers.write("input_int_register_1", int(is_async))
        registers.write(COMMAND_REGISTER, code)

    def do(self, code: int, arguments: Sequence[float] = (), is_async: bool = False) -> float:
        """Do a command to its end, with the handshake; return how long it took."""
        self.write(code, arguments, is_async)
        time_s = self.run_until(lambda: self.answer == DONE)
        self.clear()
        return time_s

    def clear(self) -> None:
        self.write(0)
        self.run_until(lambda: self.answer == READY)
