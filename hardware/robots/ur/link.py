"""The driver's end of the worker process: it starts it, asks it, watches it, and ends it."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_handles
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Any

from core.geometry import AnyArray
from hardware.errors import RobotError, RobotLost, RobotUnreachable
from hardware.robots.ur.mailbox import StateMailbox
from hardware.robots.ur.messages import Connected, Ended, Reply, Request, Setup, Started

START_S = 30.0
"""A process starts in half a second, and in ten on a machine with too much to do."""
CONNECT_S = 10.0
"""Connecting takes half a second, and 5 s until ur_rtde gives up starting its program."""
LOST_S = 0.37
"""A state that is older, and still so after `_LOOK_S`, is lost: the worker is frozen, or the link is."""
_LOOK_S = 0.03
_ANSWER_S = 2.0
_END_S = 1.0


def _work(setup: Setup, connection: Connection, mailbox: StateMailbox) -> None:
    """In the new process."""
    # Late, so that the parent never loads ur_rtde.
    from hardware.robots.ur.worker import serve

    serve(setup, connection, mailbox)


class WorkerLink:
    """One worker's life. A lost worker is ended and not started again: that is a person's decision."""

    def __init__(
        self,
        setup: Setup,
        on_ended: Callable[[Ended], None],
        on_lost: Callable[[RobotLost], None],
    ) -> None:
        """Start a worker and wait until it is connected.

        Args:
            setup: what it has to know.
            on_ended: called from a thread of its own when a move is over.
            on_lost: called from that thread when the worker is lost, after it was ended.

        Raises:
            RobotError: it could not connect.
        """
        context = multiprocessing.get_context("spawn")
        self._address = setup.address
        self._on_ended, self._on_lost = on_ended, on_lost
        self._mailbox = StateMailbox(context)
        self._connection, theirs = context.Pipe()
        self._process = context.Process(
            target=_work, args=(setup, theirs, self._mailbox), name="ur worker", daemon=True
        )
        self._numbers = count()
        self._replies: dict[int, SimpleQueue[RobotError | None]] = {}
        self._send_lock = Lock()
        self._is_ending = Event()
        self._process.start()
        theirs.close()
        try:
            self._wait_until_connected()
        except BaseException:
            self._kill()
            raise
        self._thread = Thread(target=self._supervise, name="ur supervision", daemon=True)
        self._thread.start()

    @property
    def process_id(self) -> int:
        """Of the worker."""
        assert self._process.pid is not None, "it was started"
        return self._process.pid

    def state(self) -> AnyArray:
        """Return the newest state of `FIELDS`.

        Raises:
            RobotLost: it is too old.
        """
        raw = self._fresh_state()
        if raw is None:
            # Where the whole machine stood still, the worker gets to run again, too, and tells the newest.
            self._is_ending.wait(_LOOK_S)
            raw = self._fresh_state()
        if raw is None:
            raise self._lost("sends nothing")
        return raw

    def ask(self, name: str, *arguments: Any, within_s: float = _ANSWER_S) -> None:
        """Let the worker do something and wait until it took it.

        Raises:
            RobotError: it refused, or does not answer in time.
        """
        number = next(self._numbers)
        reply = self._replies[number] = SimpleQueue[RobotError | None]()
        try:
            self._send(Request(number, name, arguments), within_s)
            error = reply.get(timeout=within_s)
        except (OSError, ValueError, Empty) as failed:
            raise self._lost(f"did not answer to '{name}'") from failed
        finally:
            del self._replies[number]
        if error is not None:
            raise error

    def end(self) -> None:
        """Stop what moves and end the worker; it is killed if it does not end by itself."""
        self._is_ending.set()
        with suppress(OSError, ValueError, TimeoutError):
            self._send(Request(next(self._numbers), "end", ()), _END_S)
            self._process.join(_END_S)
        self._thread.join()
        self._kill()

    def _fresh_state(self) -> AnyArray | None:
        raw = self._mailbox.read()
        if raw is None or self._is_ending.is_set() or time.monotonic() - raw["time_s"] > LOST_S:
            return None
        return raw

    def _send(self, request: Request, within_s: float) -> None:
        if not self._send_lock.acquire(timeout=within_s):
            raise TimeoutError
        try:
            self._connection.send(request)
        finally:
            self._send_lock.release()

    def _wait_until_connected(self) -> None:
        self._first(START_S)
        connected = self._first(CONNECT_S)
        if isinstance(connected, Connected) and connected.error is not None:
            raise connected.error
        deadline_s = time.monotonic() + CONNECT_S
        while self._mailbox.read() is None:
            if time.monotonic() > deadline_s:
                raise self._lost("sends nothing")
            time.sleep(_LOOK_S / 10)

    def _first(self, within_s: float) -> Started | Connected:
        """One of the worker's first two messages."""
        if not self._connection.poll(within_s):
            raise RobotUnreachable(
                f"The controller at {self._address} answers on its ports but says nothing more; restart it, "
                "then try again."
            )
        try:
            message: Started | Connected = self._connection.recv()
        except EOFError as error:
            raise RobotUnreachable(
                f"The driver broke off while it connected to {self._address}; restart the controller, then "
                "try again."
            ) from error
        return message

    def _supervise(self) -> None:
        """Hand on what the worker says until it ends; a frozen or dead one is ended and told of."""
        while not self._is_ending.is_set():
            try:
                wait_for_handles([self._connection, self._process.sentinel], _LOOK_S)
                while self._connection.poll():
                    self._take(self._connection.recv())
                self.state()
                continue
            except RobotLost as error:
                lost = error
            except (EOFError, OSError):
                lost = self._lost("is gone: its driver's process has ended")
            if self._is_ending.is_set():
                return
            self._is_ending.set()
            self._kill()
            for reply in list(self._replies.values()):
                reply.put(lost)
            self._on_lost(lost)

    def _take(self, message: Reply | Ended) -> None:
        if isinstance(message, Ended):
            self._on_ended(message)
        elif message.number in self._replies:
            self._replies[message.number].put(message.error)

    def _kill(self) -> None:
        self._process.kill()
        self._process.join()
        self._connection.close()

    def _lost(self, what: str) -> RobotLost:
        return RobotLost(
            f"The robot at {self._address} {what}, so what it does is not known; look at the arm and at the "
            "network cable, then recover the robot."
        )
