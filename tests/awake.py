"""A clock that rests while the whole machine stands still, as a virtual one does for tenths of a second."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread

_BEAT_S = 0.005
_STANDSTILL_S = 0.05
"""Later than this after a beat no process was running; less is what busy processors do."""


class AwakeClock:
    """Counts seconds in which this process could run; used as a context manager."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._over = Event()
        self._last_s = time.monotonic()
        self._stood_s = 0.0
        self._thread = Thread(target=self._watch, daemon=True)

    def __enter__(self) -> AwakeClock:
        self._last_s = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._over.set()
        self._thread.join()

    def now_s(self) -> float:
        """Return a time of which only differences mean something."""
        with self._lock:
            return self._beat() - self._stood_s

    def _watch(self) -> None:
        while not self._over.wait(_BEAT_S):
            with self._lock:
                self._beat()

    def _beat(self) -> float:
        now_s = time.monotonic()
        late_s = now_s - self._last_s - _BEAT_S
        if late_s > _STANDSTILL_S:
            self._stood_s += late_s
        self._last_s = now_s
        return now_s


class TooLate(AssertionError):
    """It was done, but not in time; that may be the machine's fault, so it is measured up to three times."""


def in_time(took_s: float, limit_s: float, what: str = "it") -> None:
    """Assert that something took less than a limit.

    Raises:
        TooLate: it took longer.
    """
    if not took_s < limit_s:
        raise TooLate(f"{what}: took {took_s:.3f} s, where less than {limit_s:g} s is asked for")


@contextmanager
def within(limit_s: float, what: str = "it") -> Iterator[None]:
    """Assert that what is done here takes less, without the time in which the whole machine stood still.

    Raises:
        TooLate: it took longer.
    """
    with AwakeClock() as clock:
        began_s = clock.now_s()
        yield
        in_time(clock.now_s() - began_s, limit_s, what)
