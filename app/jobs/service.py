"""What lives in a host process: a service, and the reporter of each of its jobs."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from app.jobs.messages import Event, Message, Progressed, Warned
from core.progress import Reporter

_MIN_INTERVAL_S = 0.05


class JobReporter(Reporter):
    """Sends progress (at most 20 times a second), warnings and events; made anew for each job."""

    def __init__(self, send: Callable[[Message], None]) -> None:
        super().__init__()
        self._send = send
        self._sent_s = 0.0
        self._stage = ""

    def progress(self, stage: str, done: float, total: float) -> None:
        """Send it, unless this stage's progress was sent just before."""
        now_s = time.monotonic()
        if stage == self._stage and done < total and now_s - self._sent_s < _MIN_INTERVAL_S:
            return
        self._stage, self._sent_s = stage, now_s
        self._send(Progressed(stage, done, total))

    def warn(self, sentence: str) -> None:
        """Send it."""
        self._send(Warned(sentence))

    def tell(self, news: object) -> None:
        """Send it as an event."""
        self.publish(news)

    def publish(self, payload: Any) -> None:
        """Send an event: a frozen dataclass that the page of this job knows."""
        self._send(Event(payload))


class ForwardingReporter(Reporter):
    """Forwards everything to a job's reporter; what derives from it adds events of its own."""

    def __init__(self, reporter: JobReporter) -> None:
        super().__init__()
        self._reporter = reporter

    def progress(self, stage: str, done: float, total: float) -> None:
        """Forward it."""
        self._reporter.progress(stage, done, total)

    def warn(self, sentence: str) -> None:
        """Forward it."""
        self._reporter.warn(sentence)

    def tell(self, news: object) -> None:
        """Forward it."""
        self._reporter.tell(news)

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` if somebody asked the job to stop."""
        self._reporter.raise_if_cancelled()


class Service:
    """State that outlives a job, such as workers or a connected arm.

    Its public methods are jobs: `method(self, reporter, ...)`, called one after the other in one thread; or
    orders: `method(self, ...) -> None`, called at once in another, so they must be short and thread-safe.
    Its module imports nothing heavy at the top: the window's process imports it, too.

    Attributes:
        GIVES_WAY: whether the window has priority on a busy machine; not where something moves.
    """

    GIVES_WAY = True

    def __init__(self, send: Callable[[Event], None]) -> None:
        """`send` takes events outside of a job; safe from any thread."""
        self._send = send

    def prepare(self) -> None:
        """Import and start what the first job would wait for."""

    def use_idle_time(self, reporter: Reporter) -> bool:  # noqa: ARG002
        """Do a little of what a later job will want; return whether there is more of it to do.

        `reporter` cancels it when the process ends; nobody reads what it reports.
        """
        return False

    def close(self) -> None:
        """Release everything; the process ends afterwards."""
