"""A gripper that does what is commanded and holds nothing."""

from __future__ import annotations


class SimulatedGripper:
    """Opens and closes at once.

    Attributes:
        name: marks it as simulated.
    """

    def __init__(self) -> None:
        """Begin open."""
        self.name = "simulated gripper"
        self._is_closed = False

    def __enter__(self) -> SimulatedGripper:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    @property
    def is_closed(self) -> bool:
        """Whether it was last commanded to close."""
        return self._is_closed

    @property
    def width_m(self) -> None:
        """Not known."""

    @property
    def is_holding(self) -> None:
        """It reports nothing of that."""

    def close(self) -> None:
        """Close."""
        self._is_closed = True

    def open(self) -> None:
        """Open."""
        self._is_closed = False
