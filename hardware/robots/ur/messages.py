"""What the driver and its worker process say to each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hardware.errors import RobotError


@dataclass(frozen=True)
class Setup:
    """What the worker has to know to connect.

    Attributes:
        address: the controller's.
        tool: (6) `T_flange_tool` as the controller writes it: metres and a rotation vector.
        payload_kg: mass at the flange.
        payload_center_m: (3) its centre, in the flange's frame.
        cycle_s: time between two of the controller's states.
    """

    address: str
    tool: list[float]
    payload_kg: float
    payload_center_m: list[float]
    cycle_s: float


@dataclass(frozen=True)
class Request:
    """A call of one of the worker's methods."""

    number: int
    name: str
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class Reply:
    """What came of a request."""

    number: int
    error: RobotError | None


@dataclass(frozen=True)
class Started:
    """The worker's first message: its process runs, and begins to connect."""


@dataclass(frozen=True)
class Connected:
    """The worker's second message: it is connected, or why it is not."""

    error: RobotError | None


@dataclass(frozen=True)
class Ended:
    """The present move is over: at its target, or elsewhere, for a reason, after a share of its way."""

    error: RobotError | None
    progress: float
