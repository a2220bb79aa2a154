"""The socket through which tests and people put faults in and look on; no fault of the link concerns it."""

from __future__ import annotations

from hardware.simulation.ur_controller.faults import FaultDesk, FaultRefused
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.line_link import LineLink
from hardware.simulation.ur_controller.link import Network

REFUSED = "error: "


class ControlLink(LineLink):
    """One line in, one line out."""

    name = "control"

    def __init__(self, desk: FaultDesk, journal: Journal) -> None:
        """Wait for lines; the connection has a network of its own, without faults."""
        super().__init__(Network(), journal)
        self._desk = desk

    def line_received(self, line: str) -> None:
        """Do it and answer."""
        try:
            self.send_line(self._desk.take(line))
        except FaultRefused as error:
            self.send_line(REFUSED + str(error))
