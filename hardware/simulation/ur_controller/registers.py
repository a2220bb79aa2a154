"""The fields that clients write, the registers that the program writes, and what it reports there."""

from __future__ import annotations

import time
from collections.abc import Iterable

from hardware.simulation.ur_controller.rtde_protocol import IN_USE, INPUT_TYPES, N_REGISTERS, NOT_FOUND

COMMAND_REGISTER = "input_int_register_0"


class Registers:
    """Inputs by name, each written by one client only; integer and floating outputs.

    Attributes:
        ints: the output_int_registers.
        doubles: the output_double_registers.
    """

    def __init__(self) -> None:
        """Begin with zeros."""
        self.ints = [0] * N_REGISTERS
        self.doubles = [0.0] * N_REGISTERS
        self._inputs: dict[str, float] = {}
        self._owners: dict[str, object] = {}
        self._command_written_s = time.monotonic()

    def claim(self, names: Iterable[str], owner: object) -> list[str]:
        """Reserve inputs for a client and return their types; `IN_USE` where another has them."""
        types = []
        for name in names:
            if name not in INPUT_TYPES:
                types.append(NOT_FOUND)
            elif self._owners.get(name, owner) is not owner:
                types.append(IN_USE)
            else:
                types.append(INPUT_TYPES[name])
                self._owners[name] = owner
        return types

    def release(self, owner: object) -> None:
        """Give back what a client had."""
        self._owners = {name: other for name, other in self._owners.items() if other is not owner}

    def take_all(self, owner: object) -> None:
        """Give every input to somebody else, as when a fieldbus or a second client holds them."""
        self._owners = dict.fromkeys(INPUT_TYPES, owner)

    def write(self, name: str, value: float) -> None:
        """Store what a client wrote."""
        self._inputs[name] = value
        if name == COMMAND_REGISTER:
            self._command_written_s = time.monotonic()

    def command_age_s(self) -> float:
        """How long ago the command register was written, by the wall clock: clients live by that one."""
        return time.monotonic() - self._command_written_s

    def leave_out(self, missed_s: float) -> None:
        """Do not count time in which the whole machine stood still: nobody could write."""
        self._command_written_s += missed_s

    def int_input(self, index: int) -> int:
        """Return an integer input."""
        return int(self._inputs.get(f"input_int_register_{index}", 0))

    def double_inputs(self, first: int, number: int) -> list[float]:
        """Return floating inputs in a row."""
        return [self._inputs.get(f"input_double_register_{k}", 0.0) for k in range(first, first + number)]

    def write_doubles(self, values: Iterable[float]) -> None:
        """Write the floating outputs from 0 on."""
        for k, value in enumerate(values):
            self.doubles[k] = float(value)


_REGISTER = 2
_COUNT_SHIFT, _ID_SHIFT = 16, 24
_RUNNING = 0x8000
_MAX = 127


class AsyncProgress:
    """The number of the operation, a count of writes, and how far it is.

    Attributes:
        is_running: whether an operation is under way.
    """

    def __init__(self, registers: Registers) -> None:
        """Begin with nothing under way."""
        self._registers = registers
        self.is_running = False
        self._count = 0
        self._id = 0

    def started(self) -> None:
        """A new operation begins."""
        self._id = 0 if self._id >= _MAX else self._id + 1
        self.reached(0)

    def reached(self, value: int) -> None:
        """It has come to a step of its path."""
        self.is_running = True
        self._write(value + _RUNNING)

    def finished(self) -> None:
        """It is over."""
        self.is_running = False
        self._write(0)

    def _write(self, low: int) -> None:
        self._count = 0 if self._count >= _MAX else self._count + 1
        self._registers.ints[_REGISTER] = (self._id << _ID_SHIFT) + (self._count << _COUNT_SHIFT) + low
