"""What a host tells of an arm, whether it scans or pours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hardware.interfaces import RobotState


@dataclass(frozen=True)
class ArmConnected:
    """An arm can be used.

    Attributes:
        name: what people call it.
        stop_address: of the controller, whose dashboard takes a stop; none for an arm in the same process.
        is_simulated: whether nothing real moves.
    """

    name: str
    stop_address: str | None
    is_simulated: bool


@dataclass(frozen=True)
class ArmStatus:
    """How an arm is, about ten times a second while it is connected.

    Attributes:
        state: its newest; none if it does not answer.
        is_gripper_closed: as read back; none if that is not known.
        problem: a sentence, if it cannot be used as it is; empty if it can.
    """

    state: RobotState | None
    is_gripper_closed: bool | None
    problem: str


@dataclass(frozen=True)
class ArmGone:
    """The arm is not connected any more; a sentence if that was not wished."""

    sentence: str = ""


@dataclass(frozen=True)
class StopDone:
    """STOP was carried out, or not: the sentence says why not."""

    seconds: float
    sentence: str = ""
