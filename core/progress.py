"""How a stage reports its progress and learns that it should stop."""

from __future__ import annotations

from threading import Event

from core.errors import Cancelled, Remedy


class Reporter:
    """Receives a stage's progress. This one stays silent; faces (terminal, window) derive from it.

    A stage calls `progress` often and `warn` for what the user should know though the work goes on. Both run
    in the process and thread of the stage's caller, never in a worker.
    """

    def __init__(self) -> None:
        self._cancel = Event()

    def progress(self, stage: str, done: float, total: float) -> None:
        """Report that `done` of `total` units of `stage` are finished."""

    def warn(self, sentence: str) -> None:
        """Report something the user should know though the work goes on."""

    def tell(self, news: object) -> None:
        """Tell what is known before the work is done: a frozen dataclass, for faces that know it."""

    def cancel(self) -> None:
        """Ask the running stage to stop; safe from any thread."""
        self._cancel.set()

    def forget_cancel(self) -> None:
        """Go on listening: what somebody asked to stop has stopped."""
        self._cancel.clear()

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` if somebody asked to stop."""
        if self._cancel.is_set():
            raise Cancelled("Stopped on request; finished stages are kept.", Remedy.CONTINUE)


class QuietReporter(Reporter):
    """Is cancelled with another reporter and tells nothing: of work inside a stage that has its own words."""

    def __init__(self, outside: Reporter) -> None:
        super().__init__()
        self._outside = outside

    def raise_if_cancelled(self) -> None:
        """See `Reporter`; it is the one outside who is asked."""
        self._outside.raise_if_cancelled()
