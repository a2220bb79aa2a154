"""A command on a terminal of its own, whose questions are answered as they come."""

from __future__ import annotations

import os
import pty
import select
import subprocess
import sys
from collections.abc import Mapping


class TerminalSession:
    """Runs `poursight` on a pseudo-terminal.

    Attributes:
        transcript: all that was shown.
        process: the command's.
    """

    def __init__(self, *words: object) -> None:
        self.transcript = ""
        self._unread = ""
        self._terminal, command_side = pty.openpty()
        environment = os.environ | {"COLUMNS": "400", "TERM": "dumb"}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "app.cli", *map(str, words)],
            stdin=command_side, stdout=command_side, stderr=command_side, env=environment,
        )  # fmt: skip
        os.close(command_side)

    @property
    def has_ended(self) -> bool:
        """Whether the command has ended."""
        return self.process.poll() is not None

    def answer(self, answers: Mapping[str, str], patience_s: float) -> int:
        """Answer each question that contains one of the words, until the command ends; return its exit code.

        Raises:
            AssertionError: nothing was shown for too long.
        """
        while True:
            ready, _, _ = select.select([self._terminal], [], [], patience_s)
            assert ready, f"nothing was shown for {patience_s} s:\n{self.transcript}"
            try:
                shown = os.read(self._terminal, 65_536).decode(errors="replace")
            except OSError:  # the command has ended
                shown = ""
            if not shown:
                os.close(self._terminal)
                return self.process.wait()
            self.transcript += shown
            self._unread += shown
            for words, reply in answers.items():
                if words in self._unread:
                    self._unread = ""
                    os.write(self._terminal, f"{reply}\n".encode())
