"""Messages between the program and a host process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

from core.errors import Remedy


@dataclass(frozen=True)
class StartJob:
    """Carry out `method(service, reporter, *arguments)`."""

    method: Callable[..., Any]
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class CancelJob:
    """Stop the running job."""


@dataclass(frozen=True)
class DoNow:
    """Carry out `method(service, *arguments)` at once, beside the running job."""

    method: Callable[..., None]
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class EndHost:
    """Stop everything and end the process."""


@dataclass(frozen=True)
class Progressed:
    """`done` of `total` units of a stage are finished."""

    stage: str
    done: float
    total: float


@dataclass(frozen=True)
class Warned:
    """Something the user should know though the work goes on."""

    sentence: str


@dataclass(frozen=True)
class Event:
    """Something happened in a job or its service; the payload is a frozen dataclass of its own."""

    payload: Any


class Status:
    """Marks payloads that say how something is now: of several that wait, only the newest is delivered."""


@dataclass(frozen=True)
class Finished:
    """The job is done."""

    result: Any


class FailureKind(Enum):
    """Why a job ended without a result."""

    CANCELLED = "cancelled"
    EXPLAINED = "explained"
    FAULT = "fault"
    DIED = "died"


@dataclass(frozen=True)
class Failed:
    """The job ended without a result.

    Attributes:
        kind: whether it was stopped, explained itself, met a fault of the program, or its process died.
        sentence: what happened and what to do.
        details: more of it, such as a traceback; may be empty.
        error: the exception's class, by name.
        remedy: what the user can do about it; none if the sentence says it.
    """

    kind: FailureKind
    sentence: str
    details: str
    error: str
    remedy: Remedy | None = None


Message = Progressed | Warned | Event | Finished | Failed
