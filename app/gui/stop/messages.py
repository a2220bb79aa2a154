"""What the window and the STOP process tell each other."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Dock:
    """To STOP: its place in the window, in the screen's logical pixels."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class Pressed:
    """To the window: STOP was pressed; the controller is being told already, where there is a channel."""


@dataclass(frozen=True)
class Answered:
    """To the window: what came of a press.

    Attributes:
        seconds: from the press to the controller's answer.
        problem: why it was not stopped, in a sentence; empty if it was.
    """

    seconds: float
    problem: str
