"""The control script that ur_rtde uploads, played natively: commands in registers, answers in registers.

The script itself is not interpreted. What it does with each command was taken from its text (ur_rtde 1.6.5).
"""

from __future__ import annotations

from collections.abc import Callable

from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.commands import HANDLERS, Asked
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.path_script import injected_moves
from hardware.simulation.ur_controller.progress import AsyncProgress
from hardware.simulation.ur_controller.registers import Registers

_READY, _DONE = 1, 2
_STOP_SCRIPT = 255
_REAL_TIME = {6, 9, 10, 11, 24, 25, 26, 27, 38, 58, *range(66, 72)}
"""These are taken in every cycle and get no 'done'."""


class ControlProgram:
    """The running script.

    Attributes:
        is_over: whether it has ended by itself.
    """

    def __init__(
        self,
        script: str,
        arm: Arm,
        registers: Registers,
        journal: Journal,
        protective_stop: Callable[[], None],
    ) -> None:
        """Begin: no command is under way, no asynchronous one is running."""
        self.is_over = False
        self._registers = registers
        self._journal = journal
        self._progress = AsyncProgress(registers)
        self._asked = Asked(arm, registers, self._progress, injected_moves(script), protective_stop)
        self._is_executing = False
        self._waiting: Callable[[], bool] | None = None
        self._last_noted: tuple[int, list[float]] | None = None
        self._progress.finished()
        registers.ints[0] = _READY

    def step(self) -> None:
        """Do what the script does in one cycle.

        Raises:
            NoSolution: the real script ends with an error here.
        """
        if self._starves():
            self._journal.note("watchdog starved")
            self.is_over = True
            return
        self._asked.follow_async()
        if self._waiting is not None:
            if self._waiting():
                self._waiting = None
                self._registers.ints[0] = _DONE
            return
        self._next_command(self._registers.int_input(0))

    def _next_command(self, code: int) -> None:
        if code == 0:
            self._is_executing = False
            self._last_noted = None
            self._registers.ints[0] = _READY
        elif code in _REAL_TIME:
            self._execute(code)
            self._registers.ints[0] = _READY
        elif not self._is_executing:
            self._is_executing = True
            if code == _STOP_SCRIPT:
                self._note(code, [], is_known=True)
                self.is_over = True
                return
            self._waiting = self._execute(code)
            if self._waiting is None:
                self._registers.ints[0] = _DONE

    def _execute(self, code: int) -> Callable[[], bool] | None:
        handler = HANDLERS.get(code)
        arguments = self._registers.double_inputs(0, handler.n_arguments if handler else 0)
        self._note(code, arguments, is_known=handler is not None)
        return handler.run(self._asked) if handler else None

    def _note(self, code: int, arguments: list[float], is_known: bool) -> None:
        """Note a command; of a stream of real-time ones the first, and how many had new arguments."""
        if (code, arguments) == self._last_noted:
            return
        is_next_of_stream = self._last_noted is not None and self._last_noted[0] == code
        self._last_noted = (code, arguments)
        self._journal.counts[f"command {code}"] += 1
        if not is_next_of_stream:
            self._journal.note("command", code=code, arguments=arguments, is_known=is_known)

    def _starves(self) -> bool:
        period_s = self._asked.watchdog_s
        return period_s is not None and self._registers.command_age_s() > period_s
