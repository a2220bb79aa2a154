"""A way to the controller for STOP alone, kept open beside whatever else talks to it."""

from __future__ import annotations

from hardware.errors import RobotLost
from hardware.robots.ur.dashboard import Dashboard

_WITHIN_S = 0.5


class StopLine:
    """Ends the program on a controller, and with it what moves, by its dashboard server.

    It needs neither the driver's process nor the one that carries out a pour. A software stop: it is no
    substitute for the emergency stop at the arm's panel.
    """

    def __init__(self, address: str) -> None:
        """Connect.

        Raises:
            RobotLost: nobody answers.
        """
        self._address = address
        self._dashboard = Dashboard(address)

    def stop(self) -> None:
        """Stop; a line that broke meanwhile is opened anew.

        Raises:
            RobotLost: the controller cannot be reached.
        """
        try:
            self._dashboard.stop(_WITHIN_S)
        except RobotLost:
            self._dashboard = Dashboard(self._address)
            self._dashboard.stop(_WITHIN_S)

    def close(self) -> None:
        """Disconnect."""
        self._dashboard.close()
