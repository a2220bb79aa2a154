"""The fields that clients write and the registers that the program writes."""

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
        """Keep what a client wrote."""
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
