"""Ctrl-C and SIGTERM, heard at once whatever the main thread is doing."""

from __future__ import annotations

import signal
import socket
from collections.abc import Callable
from threading import Thread

_NUMBERS = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """Calls a function, in a thread of its own, for each request to stop; used as a context manager.

    Attributes:
        was_terminated: whether one of them was SIGTERM, after which nobody is there to be asked.

    Python runs a signal's handler in the main thread, between two of its instructions: a long call into C
    would delay it. What the signal writes into a socket is read here meanwhile.
    """

    def __init__(self, heard: Callable[[], None]) -> None:
        self.was_terminated = False
        self._heard = heard

    def __enter__(self) -> Interrupts:
        self._reading, self._writing = socket.socketpair()
        self._writing.setblocking(False)
        self._wakeup_fd = signal.set_wakeup_fd(self._writing.fileno())
        self._handlers = {number: signal.signal(number, _leave_to_the_thread) for number in _NUMBERS}
        self._thread = Thread(target=self._listen, name="interrupts", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *exception: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._wakeup_fd)
        self._writing.close()
        self._thread.join()
        self._reading.close()

    def _listen(self) -> None:
        while number := self._reading.recv(1):
            if number[0] in _NUMBERS:
                self.was_terminated = self.was_terminated or number[0] == signal.SIGTERM
                self._heard()


def _leave_to_the_thread(*signal_and_frame: object) -> None:
    """Python writes into the socket only where it has a handler of its own to run."""
