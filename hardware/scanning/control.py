"""How whoever watches a scan holds it up; stopping it is the reporter's cancel."""

from __future__ import annotations

from threading import Event

from core.progress import Reporter

_POLL_S = 0.05


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
        """Let the arm stand after the view it is at."""
        self._may_go_on.clear()

    def resume(self) -> None:
        """Go on."""
        self._may_go_on.set()

    def wait_while_paused(self, reporter: Reporter) -> None:
        """Return when the scan may go on.

        Raises:
            Cancelled: somebody asked to stop.
        """
        reporter.raise_if_cancelled()
        while not self._may_go_on.wait(_POLL_S):
            reporter.raise_if_cancelled()
