"""Connections that talk in lines of text."""

from __future__ import annotations

from hardware.simulation.ur_controller.link import Link

_MAX_LINE_BYTES = 1 << 16


class LineLink(Link):
    """One client that sends lines; subclasses say what each means."""

    _rest = b""

    def received(self, data: bytes) -> None:
        """Cut into lines."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            self.line_received(line.decode("utf-8", errors="replace").strip())
        if len(self._rest) > _MAX_LINE_BYTES:
            self.abort()

    def line_received(self, line: str) -> None:
        """What to do with a line, without its end."""
        raise NotImplementedError

    def send_line(self, line: str) -> None:
        """Send a line of text."""
        self.send(line.encode() + b"\n")
