"""The script port: programs come as text, nothing is answered."""

from __future__ import annotations

from hardware.simulation.ur_controller.controller import Controller
from hardware.simulation.ur_controller.link import Link, Network

_MAX_BYTES = 1 << 20


class ScriptLink(Link):
    """One client that sends scripts."""

    name = "script"

    def __init__(self, network: Network, controller: Controller) -> None:
        """Wait for text."""
        super().__init__(network, controller.journal)
        self._controller = controller
        self._text = ""

    def received(self, data: bytes) -> None:
        """Collect text and hand on each program that is complete."""
        self._text += data.decode("utf-8", errors="replace")
        while (program := self._take_program()) is not None:
            if program.strip():
                self._controller.upload(program)
        if len(self._text) > _MAX_BYTES:
            self._journal.note("endless script", size=len(self._text))
            self._text = ""

    def _take_program(self) -> str | None:
        """A `def ... end` whose `end` stands at the line's start, or a single line."""
        text = self._text.lstrip("\n")
        last_line = "\nend\n" if text.startswith(("def ", "sec ")) else "\n"
        program, found, rest = text.partition(last_line)
        if not found:
            return None
        self._text = rest
        return program + found
