"""Letting whoever goes from view to view wait."""

from __future__ import annotations

from threading import Event

from core.progress import Reporter
from hardware.scanning.moving import POLL_S


class ScanControl:
    """Pauses a scan between two views; safe from any thread."""

    def __init__(self) -> None:
        self._may_go_on = Event()
        self._may_go_on.set()

    @property
    def is_paused(self) -> bool:
        """Whether the scan waits, or will before its next move."""
        return not self._may_go_on.is_set()

    def pause(self) -> None:
        """Let the arm wait after the view it is at."""
        self._may_go_on.clear()

    def resume(self) -> None:
        """Go on."""
        self._may_go_on.set()

    def wait_while_paused(self, reporter: Reporter) -> None:
        """Return when the scan may go on.

        Raises:
            Cancelled: on request.
        """
        reporter.raise_if_cancelled()
        while not self._may_go_on.wait(POLL_S):
            reporter.raise_if_cancelled()
