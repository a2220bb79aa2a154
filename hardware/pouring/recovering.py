"""Making a stopped arm ready again, with every step in the log of the run that was stopped."""

from __future__ import annotations

from hardware.errors import DeviceError
from hardware.interfaces import ReadyStep, Robot
from hardware.pouring.run_log import RunLog


class LoggedRecovery:
    """An arm that is made ready, step by step; what was done, and what refused, is written down."""

    def __init__(self, robot: Robot, log: RunLog) -> None:
        self._robot = robot
        self._log = log

    def take_step(self, step: ReadyStep) -> None:
        """Do what somebody confirmed; the arm follows no path.

        Raises:
            DeviceError: it could not be done.
        """
        try:
            self._robot.take_step(step)
        except DeviceError as error:
            self._log.event("step failed", str(error), step=step.name)
            raise
        self._log.event("step", f"Confirmed and done: {step.value}.", step=step.name)

    def recover(self) -> None:
        """Make the arm accept moves again; it does not move.

        Raises:
            DeviceError: a person has to do something first.
        """
        try:
            self._robot.recover()
        except DeviceError as error:
            self._log.event("not ready", str(error))
            raise
        self._log.event("recovered", "The arm was made ready again.")
