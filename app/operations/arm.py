"""What pouring and scanning with an arm have in common: who is asked, and how it is made ready again."""

from __future__ import annotations

from typing import Protocol

from core.errors import PoursightError
from hardware.errors import DeviceError


class ArmOperator(Protocol):
    """The person at the arm. Each `confirm` raises `Cancelled` if the answer is no; then nothing moves."""

    @property
    def is_present(self) -> bool:
        """Whether somebody refills the cup, and finds and fixes what stopped the arm."""
        ...

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:
        """Whether an arm that was stopped by `error`, or by a request to cancel, shall be made ready again.

        It does not move. The request to cancel has been met: it is to be forgotten.
        """
        ...


class Recoverable(Protocol):
    """An arm, or what is done with one."""

    def recover(self) -> None:
        """Make the arm accept moves again; raises `RobotError` if a person has to do something first."""
        ...


def recover(robot: Recoverable, operator: ArmOperator, error: PoursightError) -> None:
    """Make an arm that was stopped ready again, as often as its operator tries; it does not move.

    Raises:
        Cancelled: the operator gives up.
    """
    operator.confirm_recovery(error, is_repeated=False)
    while True:
        try:
            robot.recover()
            return
        except DeviceError as reason:
            operator.confirm_recovery(reason, is_repeated=True)
