"""The one job that is under way: started here, shown in the bar, cancelled, told of when it ends."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from PySide6.QtCore import QObject, QTimer, Signal

from app.gui.desk.inbox import Inbox
from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind, Finished, Message, News, Progressed, Warned
from app.jobs.service import Service

S = TypeVar("S", bound=Service)

_TICK_MS = 250
_SOONEST_GUESS_S = 1.0
"""A guess at the time left needs some time to be worth its ink."""


@dataclass
class RunningJob:
    """A job as the bar shows it.

    Attributes:
        title: what it does, such as "Imagine".
        page: key of the page it belongs to.
        stage: what is under way, by the pipeline's name.
        fraction: of that stage, 0 to 1.
        is_cancelling: whether somebody asked to stop it.
        start_again: begins the same job once more; none for those that need another look before.
    """

    title: str
    page: str
    start_again: Callable[[], None] | None = field(repr=False)
    host: Host[Any] = field(repr=False)
    patience_s: float = 1.0
    stage: str = ""
    fraction: float = 0.0
    is_cancelling: bool = False
    began_s: float = field(default_factory=time.monotonic)
    stage_began_s: float = field(default_factory=time.monotonic)

    @property
    def seconds_left(self) -> float | None:
        """Of the stage under way, by its speed so far; none as long as that is a guess in the dark."""
        spent_s = time.monotonic() - self.stage_began_s
        if self.fraction <= 0.02 or spent_s < _SOONEST_GUESS_S:
            return None
        return spent_s * (1 - self.fraction) / self.fraction

    def progress(self, message: Progressed) -> None:
        """Take over how far it is."""
        if message.stage != self.stage:
            self.stage, self.stage_began_s = message.stage, time.monotonic()
        self.fraction = message.done / message.total if message.total else 0.0


class Jobs(QObject):
    """Runs one job at a time in one of the hosts.

    Signals carry: `started` and `progressed` the `RunningJob`; `finished` it and the result; `failed` it and
    the `Failed`; `warned` a sentence; `news` a payload, of a job or of a service by itself.
    """

    started = Signal(object)
    progressed = Signal(object)
    finished = Signal(object, object)
    failed = Signal(object, object)
    warned = Signal(str)
    news = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.running: RunningJob | None = None
        self._hosts: list[Host[Any]] = []
        self._once_only: set[Host[Any]] = set()
        self._then: Callable[[Any], None] | None = None
        self._inbox = Inbox(self._hear, self)
        self._tick = QTimer(self, interval=_TICK_MS)
        self._tick.timeout.connect(self._tell_progress)
        self._enforce = QTimer(self, singleShot=True)
        self._enforce.timeout.connect(self._kill)

    def make_host(self, kind: type[S], name: str, *, is_repeatable: bool = True) -> Host[S]:
        """Make a host whose messages come here.

        Args:
            kind: its service's class.
            name: what its process does, as in "imagines".
            is_repeatable: whether a failed job of it may simply be begun again; not where things move.
        """
        hosts: list[Host[S]] = []
        host: Host[S] = Host(kind, name, lambda message: self._inbox.put(hosts[0], message))
        hosts.append(host)
        self._hosts.append(host)
        if not is_repeatable:
            self._once_only.add(host)
        return host

    @property
    def is_idle(self) -> bool:
        """Whether a job can be started."""
        return self.running is None

    def start(
        self,
        title: str,
        page: str,
        host: Host[Any],
        method: Callable[..., Any],
        *arguments: Any,
        then: Callable[[Any], None] | None = None,
        patience_s: float = 1.0,
    ) -> None:
        """Begin a job; nothing happens while another one is under way (its buttons are disabled then).

        Args:
            title: what it does, for the bar, such as "Imagine".
            page: key of the page it belongs to.
            host: that does it.
            method: of the host's service.
            *arguments: for it.
            then: told the result, after `finished`.
            patience_s: how long a cancelled job may take to stop before its process is ended.
        """
        if self.running is not None:
            return
        again = partial(self.start, title, page, host, method, *arguments, then=then, patience_s=patience_s)
        self.running = RunningJob(title, page, None if host in self._once_only else again, host, patience_s)
        self._then = then
        self._tick.start()
        self.started.emit(self.running)
        host.start(method, *arguments)

    def cancel(self) -> None:
        """Ask the job to stop; its process is ended if it does not."""
        job = self.running
        if job is None or job.is_cancelling:
            return
        job.is_cancelling = True
        job.host.cancel()
        self._enforce.start(round(1000 * job.patience_s))
        self.progressed.emit(job)

    def close(self) -> None:
        """End all processes; nothing is told any more."""
        self._tick.stop()
        self._enforce.stop()
        self.blockSignals(True)
        for host in self._hosts:
            host.close()

    def _kill(self) -> None:
        if self.running is not None:
            self.running.host.kill()

    def _tell_progress(self) -> None:
        if self.running is not None:
            self.progressed.emit(self.running)

    def _hear(self, host: Host[Any], message: Message) -> None:
        if isinstance(message, News):
            self.news.emit(message.payload)
        elif isinstance(message, Warned):
            self.warned.emit(message.sentence)
        elif self.running is None or self.running.host is not host:
            return  # the last words of a job that was ended
        elif isinstance(message, Progressed):
            self.running.progress(message)
        else:
            self._end(self.running, message)

    def _end(self, job: RunningJob, message: Finished | Failed) -> None:
        then, self._then, self.running = self._then, None, None
        self._tick.stop()
        self._enforce.stop()
        if isinstance(message, Finished):
            self.finished.emit(job, message.result)
            if then is not None:
                then(message.result)
        else:
            self.failed.emit(job, _as_wished(job, message))


def _as_wished(job: RunningJob, failed: Failed) -> Failed:
    """A process that was ended because its job would not stop has done what was asked."""
    if job.is_cancelling and failed.kind is FailureKind.DIED:
        said = "Stopped on request; finished stages are kept."
        return Failed(FailureKind.CANCELLED, said, failed.details, failed.error)
    return failed
