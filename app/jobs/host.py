"""The program's side of a host process: a crash or a kill there is a message, never a lost window."""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

from typing_extensions import TypeVarTuple, Unpack

from app.jobs.face import JobFace
from app.jobs.host_process import serve
from app.jobs.messages import CancelJob, DoNow, EndHost, Failed, FailureKind, Finished, Message, StartJob
from app.jobs.service import Service

S = TypeVar("S", bound=Service)
Arguments = TypeVarTuple("Arguments")

_ENDING_S = 3.0


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
            listen: told every message, in a thread of the host's.
        """
        self.is_busy = False
        self._kind = kind
        self._name = name
        self._listen = listen
        self._context = multiprocessing.get_context("spawn")
        self._process: BaseProcess | None = None
        self._connection: Connection | None = None
        self._hearing: threading.Thread | None = None
        self._lock = threading.Lock()

    @property
    def pid(self) -> int | None:
        """Of the process, while it runs."""
        return self._process.pid if self._process is not None else None

    def open(self) -> None:
        """Start the process now, so that the first job need not wait for it."""
        with self._lock:
            if self._connection is not None:
                return
            ours, theirs = self._context.Pipe()
            process = self._context.Process(target=serve, args=(self._kind, theirs), name=self._name)
            process.start()
            theirs.close()
            self._process, self._connection = process, ours
            self._hearing = threading.Thread(target=self._hear, args=(ours,), name=self._name, daemon=True)
            self._hearing.start()

    def start(
        self, method: Callable[[S, JobFace, Unpack[Arguments]], Any], *arguments: Unpack[Arguments]
    ) -> None:
        """Begin a job; its end comes as `Finished` or `Failed`."""
        if self.is_busy:
            raise RuntimeError("one job at a time")
        self.is_busy = True
        self._send(StartJob(method, arguments))

    def order(self, method: Callable[[S, Unpack[Arguments]], None], *arguments: Unpack[Arguments]) -> None:
        """Let the service do something at once, beside a running job; nothing if there is no process."""
        if self._connection is not None:
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
            process, connection, hearing = self._process, self._connection, self._hearing
            self._process = self._connection = None
        if process is None or connection is None or hearing is None:
            return
        with suppress(OSError):
            connection.send(EndHost())
        process.join(_ENDING_S)
        if process.is_alive():
            process.kill()
            process.join()
        hearing.join()
        connection.close()

    def _send(self, message: StartJob | CancelJob | DoNow) -> None:
        self.open()
        connection = self._connection
        with suppress(OSError):  # it died: `_hear` tells
            if connection is not None:
                connection.send(message)

    def _hear(self, connection: Connection) -> None:
        while True:
            try:
                message = connection.recv()
            except (EOFError, OSError):
                break
            if isinstance(message, Finished | Failed):
                self.is_busy = False
            self._listen(message)
        self._forget(connection)

    def _forget(self, connection: Connection) -> None:
        """The process is gone: the next job starts another."""
        with self._lock:
            if self._connection is not connection:
                return  # closed on purpose
            process, self._process, self._connection = self._process, None, None
        connection.close()
        if process is not None:
            process.join(_ENDING_S)
        if self.is_busy:
            self.is_busy = False
            code = process.exitcode if process is not None else None
            self._listen(
                Failed(
                    FailureKind.DIED,
                    f"The process that {self._name} has ended unexpectedly (killed, or out of memory?); what "
                    "was finished before is kept, so try again.",
                    f"exit code {code}",
                    "WorkerError",
                )
            )
