"""The base of what lives in a host process."""

from __future__ import annotations

from collections.abc import Callable

from app.jobs.messages import News


class Service:
    """State that outlives a job, such as workers or a connected arm.

    Its public methods are jobs: `method(self, face, ...)`, called one after the other in one thread; or
    orders: `method(self, ...) -> None`, called at once in another, so they must be short and thread-safe.
    Its module imports nothing heavy at the top: the window's process imports it, too.

    Attributes:
        GIVES_WAY: whether the window goes before its work on a busy machine; not where something moves.
    """

    GIVES_WAY = True

    def __init__(self, tell: Callable[[News], None]) -> None:
        """`tell` sends news outside of a job; safe from any thread."""
        self._tell = tell

    def prepare(self) -> None:
        """Import and start what the first job would wait for."""

    def close(self) -> None:
        """Let go of everything; the process ends afterwards."""
