"""What a host process and the program say to each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any


@dataclass(frozen=True)
class StartJob:
    """Carry out `method(service, face, *arguments)`."""

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
class News:
    """Whatever a job or its service tells on the way; a frozen dataclass of its own."""

    payload: Any


class Status:
    """Marks news that tell how something is now: of several that wait, only the newest is handed on."""


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
        details: for whoever wants to know more, such as a traceback; may be empty.
        error: the exception's class, by name.
    """

    kind: FailureKind
    sentence: str
    details: str
    error: str


Message = Progressed | Warned | News | Finished | Failed
