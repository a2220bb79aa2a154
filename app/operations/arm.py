"""What pouring and scanning with an arm have in common: who is asked, and how it is made ready."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol, TypeVar

from core.errors import PoursightError
from core.progress import Reporter
from hardware.cell import CellSettings
from hardware.cell.own_arm import why_other_arm
from hardware.errors import DeviceError, RobotError
from hardware.interfaces import ReadyStep, Robot


class ArmOperator(Protocol):
    """The person at the arm. Each `confirm` raises `Cancelled` if the answer is no; then nothing moves."""

    @property
    def is_present(self) -> bool:
        """Whether somebody refills the cup, and finds and fixes what stopped the arm."""
        ...

    def confirm_step(self, step: ReadyStep, why: str) -> None:
        """Whether this shall be done on the way to an arm that can be used; `why` says what is the case."""
        ...

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:
        """Whether an arm that was stopped by `error`, or by a request to cancel, shall be made ready again.

        It does not move. The request to cancel has been met: it is to be forgotten.
        """
        ...


class ArmDevice(Protocol):
    """What has a robot and is entered to connect it."""

    settings: CellSettings
    robot: Robot

    def __enter__(self) -> object: ...

    def __exit__(self, *exception: object) -> None: ...


D = TypeVar("D", bound=ArmDevice)


@contextmanager
def connected(device: D, operator: ArmOperator | None, reporter: Reporter) -> Iterator[D]:
    """Connect an arm; what is in the way is done step by step, each confirmed, if an operator is there.

    Where its own kinematics could not be read, what that costs is said.

    Raises:
        DeviceError: it cannot be connected as it is.
        Cancelled: a step was not confirmed.
    """
    while True:
        try:
            device.__enter__()
            break
        except RobotError:
            pending = device.robot.pending_step()
            if operator is None or not operator.is_present or pending is None:
                raise
        operator.confirm_step(*pending)
        device.robot.take_step(pending[0])
    try:
        warn_of_kinematics(device, reporter)
        yield device
    finally:
        device.__exit__(None, None, None)


def warn_of_kinematics(device: ArmDevice, reporter: Reporter) -> None:
    """Say what it costs that a connected arm's own kinematics are not known, or not those of its cell."""
    kinematics = device.robot.kinematics
    for sentence in (kinematics.caution, why_other_arm(device.settings, kinematics)):
        if sentence:
            reporter.warn(sentence)


class Recoverable(Protocol):
    """An arm, or what is done with one."""

    def recover(self) -> None:
        """Make the arm accept moves again; raises `RobotError` if a person has to do something first."""
        ...

    def take_step(self, step: ReadyStep) -> None:
        """Do what has to be done first; raises `RobotError` if it could not be done."""
        ...


def recover(stopped: Recoverable, robot: Robot, operator: ArmOperator, error: PoursightError) -> None:
    """Make what was stopped ready again, as often as its operator tries; nothing moves.

    Raises:
        Cancelled: the operator gives up.
    """
    operator.confirm_recovery(error, is_repeated=False)
    while True:
        try:
            stopped.recover()
            return
        except DeviceError as reason:
            pending = robot.pending_step()
            if pending is None:
                operator.confirm_recovery(reason, is_repeated=True)
                continue
        operator.confirm_step(*pending)
        try:
            stopped.take_step(pending[0])
        except DeviceError as reason:
            operator.confirm_recovery(reason, is_repeated=True)
