"""A motion of the real arm, as its caller sees it."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event, Lock

from hardware.errors import RobotError


class UrMove:
    """A motion on its way; made by `UR5Robot`, which tells it how it ended."""

    def __init__(self, name: str, progress: Callable[[], float], stop: Callable[[], None]) -> None:
        """Belong to a robot of this name."""
        self._name = name
        self._ask_progress, self._stop = progress, stop
        self._progress = 0.0
        self._error: RobotError | None = None
        self._is_over = Event()
        self._lock = Lock()

    @property
    def is_done(self) -> bool:
        """Whether it has ended, at its target or not."""
        return self._is_over.is_set()

    @property
    def progress(self) -> float:
        """Share of the way that is done, 0 to 1."""
        asked = 0.0 if self._is_over.is_set() else min(self._ask_progress(), 1.0)
        with self._lock:  # it may have ended meanwhile, and what was asked before must not stay
            if not self._is_over.is_set():
                self._progress = max(self._progress, asked)
            return self._progress

    def wait(self, timeout_s: float) -> None:
        """Wait until the target is reached.

        Raises:
            RobotStopped: the motion ended elsewhere; its kind and sentence say why.
            RobotError: it did not end in time, or the robot is lost.
        """
        if not self._is_over.wait(timeout_s):
            raise RobotError(f"The {self._name} did not arrive within {timeout_s:g} s; stop it.")
        if self._error is not None:
            raise self._error

    def stop(self) -> None:
        """Stop where the arm is now."""
        if not self._is_over.is_set():
            self._stop()

    def end(self, error: RobotError | None, progress: float = 0.0) -> None:
        """Say that it is over, and after which share of the way; only the first word counts."""
        with self._lock:
            if self._is_over.is_set():
                return
            self._error = error
            self._progress = 1.0 if error is None else max(self._progress, progress)
            self._is_over.set()
