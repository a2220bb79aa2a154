"""The child's side of a host: one thread listens, another works."""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
import time
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

from app.jobs.face import JobFace
from app.jobs.messages import CancelJob, DoNow, EndHost, Failed, FailureKind, Finished, Message, StartJob
from app.jobs.service import Service
from core.errors import Cancelled, PoursightError

_CLOSING_S = 2.0
_NICENESS = 10


def serve(kind: type[Service], connection: Connection) -> None:
    """Carry out jobs until the program goes away or closes the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the program's to understand
    _quiet_stdout()
    _Host(kind, connection).run()


class _Host:
    def __init__(self, kind: type[Service], connection: Connection) -> None:
        self._connection = connection
        self._sending = threading.Lock()
        self._service = kind(self._send)
        self._jobs: queue.SimpleQueue[StartJob] = queue.SimpleQueue()
        self._face = JobFace(self._send)

    def run(self) -> None:
        threading.Thread(target=self._work, daemon=True).start()
        try:
            while not isinstance(message := self._connection.recv(), EndHost):
                self._hear(message)
        except (EOFError, OSError):
            pass  # the program is gone
        self._end()

    def _hear(self, message: Any) -> None:
        if isinstance(message, StartJob):
            self._face = JobFace(self._send)  # made here, so that a cancel that follows at once finds it
            self._jobs.put(message)
        elif isinstance(message, CancelJob):
            self._face.cancel()
        elif isinstance(message, DoNow):
            with suppress(PoursightError):
                message.method(self._service, *message.arguments)

    def _work(self) -> None:
        if self._service.GIVES_WAY:
            os.nice(_NICENESS)  # of this thread and of what it starts; the listening one stays quick
        self._service.prepare()
        while True:
            job = self._jobs.get()
            self._send(self._carry_out(job))

    def _carry_out(self, job: StartJob) -> Message:
        try:
            self._face.raise_if_cancelled()
            return Finished(job.method(self._service, self._face, *job.arguments))
        except Cancelled as error:
            return Failed(FailureKind.CANCELLED, str(error), "", type(error).__name__)
        except PoursightError as error:
            details = "".join(traceback.format_exception(error))
            return Failed(FailureKind.EXPLAINED, str(error), details, type(error).__name__)
        except BaseException as error:  # a fault of the program: the window must hear of it, whatever it is
            said = f"A fault of the program ended this ({type(error).__name__}: {error}); try it again."
            details = "".join(traceback.format_exception(error))
            return Failed(FailureKind.FAULT, said, details, type(error).__name__)

    def _send(self, message: Message) -> None:
        with self._sending, suppress(OSError):  # nobody listens any more: `run` notices it, too
            self._connection.send(message)

    def _end(self) -> None:
        """Let the running job stop, close the service, and be gone in any case.

        Returning lets Python clean up what it shares with the workers; it does not wait for the job's thread.
        """
        threading.Thread(target=_leave_soon, daemon=True).start()
        self._face.cancel()
        self._service.close()


def _leave_soon() -> None:
    time.sleep(_CLOSING_S)
    os._exit(1)


def _quiet_stdout() -> None:
    """PyBullet and its EGL plugin write to file descriptor 1 from C."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123 - open as long as the process
