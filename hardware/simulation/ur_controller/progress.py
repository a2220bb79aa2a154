"""Progress of asynchronous commands, as the control script tells it in output_int_register_2."""

from __future__ import annotations

from hardware.simulation.ur_controller.registers import Registers

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
