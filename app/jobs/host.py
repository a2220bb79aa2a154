"""A host process, both of its sides: a crash or a kill there is a message, never a lost window.

The program's side is a `Host`. In the child one thread listens, and another one works.
"""

from __future__ import annotations

import os
import queue
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, Generic, TypeVar

from typing_extensions import TypeVarTuple, Unpack

from app.jobs.messages import CancelJob, DoNow, EndHost, Failed, FailureKind, Finished, Message, StartJob
from app.jobs.service import JobReporter, Service
from core.child_process import ChildProcess
from core.errors import Cancelled, PoursightError
from core.progress import Reporter

S = TypeVar("S", bound=Service)
Arguments = TypeVarTuple("Arguments")

_CLOSING_S = 2.0
"""For a process that ends by itself, ..."""
_ENDING_S = 3.0
"""... and until it is ended if it does not."""
_NICENESS = 10


class Host(Generic[S]):
    """One process with one service; started when first needed, and again after it died.

    Attributes:
        is_busy: whether a job is under way.
    """

    def __init__(self, kind: type[S], name: str, listen: Callable[[Message], None]) -> None:
        """Make a host; no process is started yet.

        Args:
            kind: the service's class.
            name: what people call it, as in "The process that imagines".
            listen: called with every message, in a thread of the host's.
        """
        self.is_busy = False
        self._kind = kind
        self._name = name
        self._listen = listen
        self._process: ChildProcess | None = None
        self._listener: threading.Thread | None = None
        self._lock = threading.Lock()

    @property
    def pid(self) -> int | None:
        """Of the process, while it runs."""
        return self._process.pid if self._process is not None else None

    def open(self) -> None:
        """Start the process now, so that the first job need not wait for it."""
        with self._lock:
            if self._process is not None:
                return
            self._process = ChildProcess(_serve, self._kind, name=self._name, grace_s=_ENDING_S)
            self._listener = threading.Thread(
                target=self._receive, args=(self._process,), name=self._name, daemon=True
            )
            self._listener.start()

    def start(
        self, method: Callable[[S, JobReporter, Unpack[Arguments]], Any], *arguments: Unpack[Arguments]
    ) -> None:
        """Begin a job; its end comes as `Finished` or `Failed`."""
        if self.is_busy:
            raise RuntimeError("one job at a time")
        self.is_busy = True
        self._send(StartJob(method, arguments))

    def order(self, method: Callable[[S, Unpack[Arguments]], None], *arguments: Unpack[Arguments]) -> None:
        """Let the service do something at once, beside a running job; nothing if there is no process."""
        if self._process is not None:
            self._send(DoNow(method, arguments))

    def cancel(self) -> None:
        """Ask the running job to stop."""
        if self.is_busy:
            self._send(CancelJob())

    def kill(self) -> None:
        """End the process at once; a running job ends as `Failed`, the next one starts a new process."""
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """End the process, with everything it started."""
        with self._lock:
            process, self._process = self._process, None
        if process is None:
            return
        with suppress(OSError):
            process.connection.send(EndHost())
        process.end(_ENDING_S)
        if self._listener is not None:
            self._listener.join()

    def _send(self, message: StartJob | CancelJob | DoNow) -> None:
        self.open()
        process = self._process
        with suppress(OSError):  # it died: `_receive` reports it
            if process is not None:
                process.connection.send(message)

    def _receive(self, process: ChildProcess) -> None:
        while True:
            try:
                message = process.connection.recv()
            except (EOFError, OSError):
                break
            if isinstance(message, Finished | Failed):
                self.is_busy = False
            self._listen(message)
        self._forget(process)

    def _forget(self, process: ChildProcess) -> None:
        """The process is gone: the next job starts another."""
        with self._lock:
            if self._process is not process:
                return  # closed on purpose
            self._process = None
        process.end(_ENDING_S)
        if self.is_busy:
            self.is_busy = False
            self._listen(
                Failed(
                    FailureKind.DIED,
                    f"The process that {self._name} has ended unexpectedly (killed, or out of memory?); what "
                    "was finished before is kept, so try again.",
                    f"exit code {process.exit_code}",
                    "WorkerError",
                )
            )


def _serve(connection: Connection, kind: type[Service]) -> None:
    """In the child: carry out jobs until the program goes away or closes the connection."""
    # Jobs bring cells. Two threads importing this package at once, to receive one and to prepare, break it.
    import hardware.cell  # noqa: F401

    _Server(kind, connection).run()


class _Server:
    def __init__(self, kind: type[Service], connection: Connection) -> None:
        self._connection = connection
        self._sending = threading.Lock()
        self._service = kind(self._send)
        self._jobs: queue.SimpleQueue[StartJob | None] = queue.SimpleQueue()
        self._reporter = JobReporter(self._send)
        self._idle = Reporter()

    def run(self) -> None:
        threading.Thread(target=self._work, daemon=True).start()
        try:
            while not isinstance(message := self._connection.recv(), EndHost):
                self._receive(message)
        except (EOFError, OSError):
            pass  # the program is gone
        self._end()

    def _receive(self, message: Any) -> None:
        if isinstance(message, StartJob):
            self._reporter = JobReporter(self._send)  # here, so that a cancel that follows at once finds it
            self._jobs.put(message)
        elif isinstance(message, CancelJob):
            self._reporter.cancel()
        elif isinstance(message, DoNow):
            with suppress(PoursightError):
                message.method(self._service, *message.arguments)
            self._jobs.put(None)  # it may have left something to do in idle time

    def _work(self) -> None:
        if self._service.GIVES_WAY:
            os.nice(_NICENESS)  # of this thread and of what it starts; the listening one stays quick
        self._service.prepare()
        while True:
            with suppress(Exception):  # whatever it is: the job that needs it will be told
                while self._jobs.empty() and self._service.use_idle_time(self._idle):
                    pass
            job = self._jobs.get()
            if job is not None:
                self._send(self._carry_out(job))

    def _carry_out(self, job: StartJob) -> Message:
        try:
            self._reporter.raise_if_cancelled()
            return Finished(job.method(self._service, self._reporter, *job.arguments))
        except Cancelled as error:
            return Failed(FailureKind.CANCELLED, str(error), "", type(error).__name__, error.remedy)
        except PoursightError as error:
            details = "".join(traceback.format_exception(error))
            return Failed(FailureKind.EXPLAINED, str(error), details, type(error).__name__, error.remedy)
        except BaseException as error:  # a fault of the program: the window must learn of it, whatever it is
            sentence = f"A fault of the program ended this ({type(error).__name__}: {error}); try again."
            details = "".join(traceback.format_exception(error))
            return Failed(FailureKind.FAULT, sentence, details, type(error).__name__)

    def _send(self, message: Message) -> None:
        with self._sending, suppress(OSError):  # nobody listens any more: `run` notices it, too
            self._connection.send(message)

    def _end(self) -> None:
        """Let the running job stop, close the service, and be gone in any case.

        Returning lets Python clean up what it shares with the workers; it does not wait for the job's thread.
        """
        threading.Thread(target=_leave_soon, daemon=True).start()
        self._idle.cancel()
        self._reporter.cancel()
        self._service.close()


def _leave_soon() -> None:
    time.sleep(_CLOSING_S)
    os._exit(1)
