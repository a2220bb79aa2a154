"""The one job that runs: started here, shown in the bar, cancelled, reported when it ends."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.gui.desk.job_steps import JobSteps
from app.gui.remedies import remedy_words
from app.gui.views.labels import with_view_numbers
from app.jobs.host import Host
from app.jobs.messages import Event, Failed, FailureKind, Finished, Message, Progressed, Status, Warned
from app.jobs.service import Service

S = TypeVar("S", bound=Service)

_TICK_MS = 250
_SOONEST_GUESS_S = 1.0
"""Earlier, an estimate of the time left would be worthless."""


@dataclass
class RunningJob:
    """A job as the bar shows it.

    Attributes:
        title: what it does, such as "Imagine".
        page: key of the page it belongs to.
        done: what is said when it is done, such as "Scan checked."
        start_again: starts the same job once more; none where the arm must be checked first.
        host: the process that does it.
        patience_s: how long it may take to stop when cancelled.
        stage: that runs, by the pipeline's name.
        fraction: of the whole job if its steps are known, else of that stage, 0 to 1.
        is_cancelling: whether it was cancelled.
        stage_began_s: when that stage began.
        steps: of the job; none if they are not known.
        counted: how many of how many units of that stage are done.
        is_endless: whether it goes on until it is cancelled.
        paused_s: when it was asked to wait; none while it goes on.
    """

    title: str
    page: str
    done: str
    start_again: Callable[[], None] | None = field(repr=False)
    host: Host[Any] = field(repr=False)
    patience_s: float = 1.0
    stage: str = ""
    fraction: float = 0.0
    is_cancelling: bool = False
    stage_began_s: float = field(default_factory=time.monotonic)
    steps: JobSteps | None = None
    counted: tuple[int, int] | None = None
    is_endless: bool = False
    paused_s: float | None = None

    @property
    def seconds_left(self) -> float | None:
        """Of the whole job if its steps are known, else of the stage that runs, by its speed so far.

        None while too little is done to estimate it, and while it waits.
        """
        if self.paused_s is not None:
            return None
        if self.steps is not None:
            return self.steps.seconds_left
        spent_s = time.monotonic() - self.stage_began_s
        if self.fraction <= 0.02 or spent_s < _SOONEST_GUESS_S:
            return None
        return spent_s * (1 - self.fraction) / self.fraction

    def pause(self) -> None:
        """Note that it waits from now on."""
        self.paused_s = time.monotonic()

    def resume(self) -> None:
        """Note that it goes on; the time that it waited says nothing about its speed."""
        if self.paused_s is not None:
            self.stage_began_s += time.monotonic() - self.paused_s
            self.paused_s = None

    def progress(self, message: Progressed) -> None:
        """Update stage and fraction."""
        if message.stage != self.stage:
            self.stage, self.stage_began_s = message.stage, time.monotonic()
        self.counted = int(message.done), round(message.total)
        self.fraction = message.done / message.total if message.total else 0.0
        if self.steps is not None:
            self.steps.progress(message.stage, self.fraction)
            self.fraction = self.steps.fraction


class Jobs(QObject):
    """Runs one job at a time in one of the hosts.

    Signals carry: `started` and `progressed` the `RunningJob`; `finished` it and the result; `failed` it and
    the `Failed`; `warned` a sentence; `event_received` an event's payload, of a job or of an idle service.
    """

    started = Signal(object)
    progressed = Signal(object)
    finished = Signal(object, object)
    failed = Signal(object, object)
    warned = Signal(str)
    event_received = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.running: RunningJob | None = None
        self._hosts: list[Host[Any]] = []
        self._once_only: set[Host[Any]] = set()
        self._then: Callable[[Any], None] | None = None
        self._inbox = Inbox(self._handle, self)
        self._tick = QTimer(self, interval=_TICK_MS)
        self._tick.timeout.connect(self._emit_progress)
        self._enforce = QTimer(self, singleShot=True)
        self._enforce.timeout.connect(self._kill)

    def make_host(self, kind: type[S], name: str, *, is_repeatable: bool = True) -> Host[S]:
        """Make a host whose messages arrive here.

        Args:
            kind: its service's class.
            name: what its process does, as in "imagines".
            is_repeatable: whether a failed job may simply be started again; not where things move.
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
        """Whether no job runs, so that one can be started."""
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
        done: str = "",
        steps: Sequence[str] = (),
    ) -> None:
        """Start a job; nothing happens while another one runs (its buttons are disabled then).

        Args:
            title: what it does, for the bar, such as "Imagine".
            page: key of the page it belongs to.
            host: the process that does it.
            method: of the host's service.
            *arguments: for it.
            then: called with the result, after `finished`.
            patience_s: how long a cancelled job may take to stop before its process is killed.
            done: what is said when it is done; else its title with "done".
            steps: the stages it will run, if there are several.
        """
        if self.running is not None:
            return
        again = partial(
            self.start,
            title,
            page,
            host,
            method,
            *arguments,
            then=then,
            patience_s=patience_s,
            done=done,
            steps=steps,
        )
        said = done or self.tr("{title}: done.").format(title=title)
        is_once_only = host in self._once_only
        self.running = RunningJob(title, page, said, None if is_once_only else again, host, patience_s)
        self.running.steps = JobSteps(steps) if steps else None
        self._then = then
        self._tick.start()
        self.started.emit(self.running)
        host.start(method, *arguments)

    def cancel(self) -> None:
        """Ask the job to stop; its process is killed if it does not."""
        job = self.running
        if job is None or job.is_cancelling:
            return
        job.is_cancelling = True
        job.host.cancel()
        self._enforce.start(round(1000 * job.patience_s))
        self.progressed.emit(job)

    def pause(self, order: Callable[[Any], None]) -> None:
        """Let the job wait; `order`, of its host's service, tells it."""
        if self.running is not None:
            self.running.host.order(order)
            self.running.pause()
            self.progressed.emit(self.running)

    def resume(self, order: Callable[[Any], None]) -> None:
        """Let the job go on; also where it waits for an answer."""
        if self.running is not None:
            self.running.host.order(order)
            self.running.resume()
            self.progressed.emit(self.running)

    def close(self) -> None:
        """End all processes; no signal is sent any more."""
        self._tick.stop()
        self._enforce.stop()
        self.blockSignals(True)
        for host in self._hosts:
            host.close()

    def _kill(self) -> None:
        if self.running is not None:
            self.running.host.kill()

    def _emit_progress(self) -> None:
        if self.running is not None:
            self.progressed.emit(self.running)

    def _handle(self, host: Host[Any], message: Message) -> None:
        if isinstance(message, Event):
            self.event_received.emit(message.payload)
        elif isinstance(message, Warned):
            self.warned.emit(with_view_numbers(message.sentence))
        elif self.running is None or self.running.host is not host:
            return  # the last message of a job that was killed
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
            self.failed.emit(job, _as_shown(job, message))


def _as_shown(job: RunningJob, failed: Failed) -> Failed:
    """Return a failure with its remedy in the window's words.

    A process that was killed because its job would not stop is a cancelled job, not a failed one.
    """
    if job.is_cancelling and failed.kind is FailureKind.DIED:
        sentence = "Stopped on request; finished stages are kept."
        return replace(failed, kind=FailureKind.CANCELLED, sentence=sentence)
    said = f"{failed.sentence} {remedy_words(failed.remedy)}".rstrip()
    return replace(failed, sentence=with_view_numbers(said))


class Inbox(QObject):
    """Hands messages of the hosts' threads to the window's thread, in their order.

    A busy window would otherwise process every state the arm ever had before it looks at a click; a pending
    state or progress is replaced by a newer one of its kind.
    """

    _arrived = Signal()

    def __init__(self, handle: Callable[[Host[Any], Message], None], parent: QObject) -> None:
        super().__init__(parent)
        self._handle = handle
        self._lock = threading.Lock()
        self._items: list[tuple[Host[Any], Message]] = []
        self._arrived.connect(self._deliver, Qt.ConnectionType.QueuedConnection)

    def put(self, host: Host[Any], message: Message) -> None:
        """Take a message; safe from any thread."""
        with self._lock:
            is_first = not self._items
            kind = _kind(message)
            if kind is not None:
                self._items = [
                    item for item in self._items if item[0] is not host or _kind(item[1]) is not kind
                ]
            self._items.append((host, message))
        if is_first:
            self._arrived.emit()

    def _deliver(self) -> None:
        with self._lock:
            items, self._items = self._items, []
        for host, message in items:
            self._handle(host, message)


def _kind(message: Message) -> type[object] | None:
    """The type of a message of which only the newest counts; none for all others."""
    if isinstance(message, Progressed):
        return Progressed
    if isinstance(message, Event) and isinstance(message.payload, Status):
        return type(message.payload)
    return None
