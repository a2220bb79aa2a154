"""The driver's end of the worker process, and a motion as the driver's caller sees it."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_handles
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Any

import numpy as np

from core.child_process import STDERR, STDOUT, ChildProcess
from core.geometry import AnyArray
from hardware.errors import RobotError, RobotLost, RobotUnreachable
from hardware.robots.ur.messages import Connected, Ended, Pulse, Reply, Request, Setup, Started, StateMailbox


class UrMove:
    """A motion under way; made by `UR5Robot`, which reports to it how it ended."""

    def __init__(self, name: str, progress: Callable[[float], float], stop: Callable[[], None]) -> None:
        """Belong to a robot of this name; `progress` tells it by what was read since a `time.monotonic`."""
        self._name = name
        self._ask_progress, self._stop = progress, stop
        self._began_s = time.monotonic()
        self._progress = 0.0
        self._error: RobotError | None = None
        self._is_over = Event()
        self._lock = Lock()

    @property
    def is_done(self) -> bool:
        """Whether it has ended, at its target or not."""
        return self._is_over.is_set()

    @property
    def progress(self) -> float:
        """Share of the path that is done, 0 to 1."""
        reported = 0.0 if self._is_over.is_set() else min(self._ask_progress(self._began_s), 1.0)
        with self._lock:  # it may have ended meanwhile, and what was reported before must not stay
            if not self._is_over.is_set():
                self._progress = max(self._progress, reported)
            return self._progress

    def wait(self, timeout_s: float) -> None:
        """Wait until the target is reached.

        Raises:
            RobotStopped: the motion ended elsewhere; its kind and sentence say why.
            RobotError: it did not end in time, or the robot is lost.
        """
        if not self._is_over.wait(timeout_s):
            raise RobotError(f"The {self._name} did not arrive within {timeout_s:g} s; stop it.")
        if self._error is not None:
            raise self._error

    def stop(self) -> None:
        """Stop where the arm is now."""
        if not self._is_over.is_set():
            self._stop()

    def end(self, error: RobotError | None, progress: float = 0.0) -> None:
        """Record that it is over, and after which share of the path; only the first report counts."""
        with self._lock:
            if self._is_over.is_set():
                return
            self._error = error
            self._progress = 1.0 if error is None else max(self._progress, progress)
            self._is_over.set()


START_S = 30.0
"""A process starts in half a second, and in ten on a machine with too much to do."""
CONNECT_S = 10.0
"""Connecting takes half a second, and 5 s until ur_rtde gives up starting its program."""
LOST_S = 0.37
"""A state that is older, and still so after `_LOOK_S`, is lost: the worker is frozen, or the link is."""
_LOOK_S, _LOOKS = 0.03, 6
_SUPERVISE_S = 0.015
_POLL_S = 0.004
_ANSWER_S = 2.0
_END_S = 1.0


def _work(connection: Connection, setup: Setup, mailbox: StateMailbox, pulse: Pulse) -> None:
    """In the new process."""
    # Late, so that the parent never loads ur_rtde.
    from hardware.robots.ur.worker import serve

    serve(connection, setup, mailbox, pulse)


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
        self._address = setup.address
        self._on_ended, self._on_lost = on_ended, on_lost
        self._mailbox = StateMailbox()
        self._pulse = Pulse()
        self._numbers = count()
        self._replies: dict[int, SimpleQueue[RobotError | None]] = {}
        self._send_lock = Lock()
        self._is_ending = Event()
        self._loss: RobotLost | None = None
        # ur_rtde prints its progress to both outputs; a worker without a parent must not go on driving.
        self._process = ChildProcess(
            _work,
            setup,
            self._mailbox,
            self._pulse,
            name="ur worker",
            silenced=(STDOUT, STDERR),
            grace_s=0.0,
        )
        self._connection = self._process.connection
        try:
            self._wait_until_connected()
        except BaseException:
            self._process.end()
            raise
        self._thread = Thread(target=self._supervise, name="ur supervision", daemon=True)
        self._thread.start()

    @property
    def process_id(self) -> int:
        """Of the worker."""
        return self._process.pid

    @property
    def is_lost(self) -> bool:
        """Whether it was given up."""
        return self._loss is not None

    def state(self) -> AnyArray:
        """Return the newest state of `FIELDS`.

        Raises:
            RobotLost: it is too old, or the worker's thread that commands the arm is stuck.
        """
        if self._loss is not None:
            raise self._loss
        raw, silence = self._newest()
        for _ in range(_LOOKS):
            if not silence:
                break
            # Where the whole machine stood still, the worker gets to run again, too, and sends the newest.
            self._is_ending.wait(_LOOK_S / _LOOKS)
            raw, silence = self._newest()
        if raw is None or silence:
            raise self._lost(silence)
        return raw

    def progress(self, since_s: float) -> float:
        """Share of the motion begun at `since_s` that is done; 0 when nothing is known of it.

        A state that was read before tells of the motion before, which was all done.
        """
        with suppress(RobotLost):
            state = self.state()
            return float(state["progress"]) if state["time_s"] >= since_s else 0.0
        return 0.0

    def comes_to_rest(self, within_s: float, speed_rad_s: float) -> bool:
        """Whether no joint is faster than a speed any more, in time.

        Raises:
            RobotLost: it is not known.
        """
        deadline_s = time.monotonic() + within_s
        while np.abs(self.state()["joint_speeds_rad_s"]).max() > speed_rad_s:
            if time.monotonic() > deadline_s:
                return False
            time.sleep(_POLL_S)
        return True

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
        self._process.end(_END_S)
        self._thread.join()

    def _newest(self) -> tuple[AnyArray | None, str]:
        """The newest state, and what is wrong with it; empty if nothing is."""
        now_s = time.monotonic()  # before it is read: this thread may have to wait then
        raw = self._mailbox.read()
        if raw is None or self._is_ending.is_set() or now_s - raw["time_s"] > LOST_S:
            return raw, "sends nothing"
        # By the state's own time: a worker that did not run is not stuck.
        return raw, "takes no commands any more" if raw["time_s"] > raw["due_s"] else ""

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
                f"The controller at {self._address} answers on its ports but sends nothing more; restart it, "
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
        """Pass on what the worker sends until it ends; a frozen or dead one is ended and reported."""
        while not self._is_ending.is_set():
            try:
                self._pulse.beat()
                wait_for_handles([self._connection, self._process.sentinel], _SUPERVISE_S)
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
            self._loss = lost
            self._is_ending.set()
            self._process.end()
            for reply in list(self._replies.values()):
                reply.put(lost)
            self._on_lost(lost)

    def _take(self, message: Reply | Ended) -> None:
        if isinstance(message, Ended):
            self._on_ended(message)
        elif message.number in self._replies:
            self._replies[message.number].put(message.error)

    def _lost(self, what: str) -> RobotLost:
        return RobotLost(
            f"The robot at {self._address} {what}, so what it does is not known; look at the arm and at the "
            "network cable, then recover the robot."
        )
