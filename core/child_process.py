"""Child processes: started fresh, ended for certain, never left behind.

Everything that must not share the program's fate runs in one: physics, rendering, the window's hosts, the
arm's driver, the simulated controller. A child is spawned, so it shares no state with its parent; it ignores
the signals that stop people's programs, because its parent obeys them and ends its children in good order;
and it ends when its parent is gone, however that came about.
"""

from __future__ import annotations

import fcntl
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_handles
from multiprocessing.process import BaseProcess
from multiprocessing.util import Finalize
from typing import NoReturn

from typing_extensions import TypeVarTuple, Unpack

Arguments = TypeVarTuple("Arguments")

SPAWN = multiprocessing.get_context("spawn")
"""How every child is started; what children share (events, arrays) must come from it, too."""

STDOUT, STDERR = 1, 2
_STOPPING = {signal.SIGINT, signal.SIGTERM}
_environment_lock = threading.Lock()
_KILL_AT_EXIT = 10  # before multiprocessing waits for all children, which do not hear its SIGTERM


class ChildProcess:
    """A child that calls `target(connection, *arguments)`, and the parent's end of the pipe between them.

    It is killed when this object is forgotten and when the parent ends, so that it never outlives its
    use. Its standard input is empty.

    Attributes:
        connection: the parent's end; it reads end-of-file once the child has ended. Open as long as somebody
            holds it, so that a thread may be receiving from it while another one ends the child.
    """

    def __init__(
        self,
        target: Callable[[Connection, Unpack[Arguments]], object],
        *arguments: Unpack[Arguments],
        name: str,
        silenced: Sequence[int] = (STDOUT,),
        grace_s: float = 0.0,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        """Start the child; it takes some tenths of a second until `target` is called.

        Args:
            target: a module-level function.
            arguments: what can be pickled, and what `SPAWN` makes to be shared.
            name: of the process, for people who look for it.
            silenced: file descriptors whose output is dropped; see `become_child`.
            grace_s: how long it may go on when its parent is gone.
            environment: added to the parent's; for what libraries read before any code of ours runs.

        Raises:
            OSError: the system starts no further process.
        """
        self.connection, theirs = SPAWN.Pipe()
        self._process = SPAWN.Process(
            target=_run, args=(target, theirs, arguments, tuple(silenced), grace_s), name=name
        )
        self._joining = threading.Lock()
        with children_ignore_signals(), _environment_with(environment or {}):
            self._process.start()
        theirs.close()
        Finalize(self, _kill, (self._process,), exitpriority=_KILL_AT_EXIT)

    @property
    def pid(self) -> int:
        """Its process id."""
        assert self._process.pid is not None, "it was started"
        return self._process.pid

    @property
    def sentinel(self) -> int:
        """A handle for `multiprocessing.connection.wait`, ready once the child has ended."""
        return self._process.sentinel

    @property
    def exit_code(self) -> int | None:
        """What it ended with, negative for a signal; none while it runs."""
        with self._joining:
            return self._process.exitcode

    def kill(self) -> None:
        """Let it end at once, without waiting until it has."""
        self._process.kill()

    def end(self, within_s: float = 0.0) -> None:
        """Wait for a child that was asked to end, and kill it if it does not; returns when it has ended.

        May be called again, and from any thread.
        """
        with self._joining:
            if within_s > 0:
                self._process.join(within_s)
            _kill(self._process)


def become_child(silenced: Sequence[int] = (STDOUT,), grace_s: float = 0.0) -> None:
    """Make this process a well-behaved child; what `ChildProcess` starts has called it already.

    Args:
        silenced: file descriptors whose output is dropped: PyBullet, its EGL plugin and ur_rtde write from C
            where people expect only what they asked for.
        grace_s: how long the process may go on when its parent is gone; with one it goes on, too, while a
            library holds the interpreter.
    """
    for number in _STOPPING:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPPING)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for descriptor in silenced:
        os.dup2(nowhere, descriptor)
    os.close(nowhere)
    if not grace_s:
        _be_killed_after_parent()
    threading.Thread(target=_end_after_parent, args=(grace_s,), daemon=True).start()


@contextmanager
def children_ignore_signals() -> Iterator[None]:
    """Let processes spawned inside not die of a signal to all: Ctrl-C, or what a service manager sends.

    It only bridges the time until they call `become_child`. A signal to the parent is delivered afterwards.
    """
    resource_tracker.ensure_running()  # would be started with the first child, and unblocks what we block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPPING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _run(
    target: Callable[..., object],
    connection: Connection,
    arguments: tuple[object, ...],
    silenced: Sequence[int],
    grace_s: float,
) -> None:
    """In the child."""
    become_child(silenced, grace_s)
    target(connection, *arguments)


def _be_killed_after_parent() -> None:
    """Have the system do it: no thread of ours runs while a library holds the interpreter, for many seconds.

    The parent's end of a pipe that it never writes to again is closed when it ends. `PR_SET_PDEATHSIG` would
    kill already when the thread ends that started this process. Source: Linux, fcntl(2), "F_SETSIG".
    """
    parent = multiprocessing.parent_process()
    if parent is None or not hasattr(fcntl, "F_SETSIG"):
        return
    fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(parent.sentinel, fcntl.F_SETSIG, signal.SIGKILL)
    flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
    fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)


def _end_after_parent(grace_s: float) -> NoReturn:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_handles([parent.sentinel])
    time.sleep(grace_s)
    os._exit(1)


def _kill(process: BaseProcess) -> None:
    process.kill()
    process.join()


@contextmanager
def _environment_with(added: Mapping[str, str]) -> Iterator[None]:
    """A spawned process has no environment of its own to be set: it inherits this process's as it is."""
    with _environment_lock:
        before = {name: os.environ.get(name) for name in added}
        os.environ.update(added)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
