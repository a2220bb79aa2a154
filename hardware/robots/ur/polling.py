"""The threads in which ur_rtde receives: they look for a state every 0.1 ms, also while the arm stands.

Measured with ur_rtde 1.6.5: a thread sleeps for 0.1 ms whenever nothing has arrived, some 2,900 times a
second, which takes 4 % of a core. There is no setting for it. The system has one: the timer slack of a
thread is how much later than asked for it may be woken. It counts for ordinary threads only.

Source: Linux, prctl(2), PR_SET_TIMERSLACK; proc_pid_timerslack_ns(5).
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock

_SLACK_NS = 4_000_000
"""Less than a cycle at 125 Hz, so that no state waits for the next one."""
_USUAL_SLACK_NS = 50_000
"""The system's own."""
_TASKS = Path("/proc/self/task")


class PollingThreads:
    """Lets ur_rtde's threads look less often while nothing is asked of the arm.

    An ordinary thread waits longer on a busy machine than one with precedence; who misses a state calls
    `hasten`, which gives it back. Without the right to change other threads (`CAP_SYS_NICE`), or without
    Linux, they go on as they were. All may be called from any thread.
    """

    def __init__(self) -> None:
        """Know of none yet."""
        self._threads: set[int] = set()
        self._policy = 0
        self._are_slack = False
        self._in_haste_until_s = 0.0
        self._lock = Lock()

    @property
    def are_slack(self) -> bool:
        """Whether they look seldom now."""
        return self._are_slack

    @contextmanager
    def starting(self) -> Iterator[None]:
        """Threads that begin inside are those that are meant, as far as they may be changed."""
        before = _tasks()
        yield
        self._threads |= {thread for thread in _tasks() - before if _set_slack(thread, _USUAL_SLACK_NS)}

    def hasten(self, for_s: float) -> None:
        """Look as often as ur_rtde does by itself, at least for this long."""
        with self._lock:
            self._in_haste_until_s = max(self._in_haste_until_s, time.monotonic() + for_s)
            if self._are_slack:
                self._are_slack = False
                self._set(self._policy, _USUAL_SLACK_NS)

    def slacken(self) -> None:
        """Look seldom, unless there is haste; a state is known up to 4 ms later."""
        with self._lock:
            if self._threads and not self._are_slack and time.monotonic() > self._in_haste_until_s:
                self._are_slack = True
                self._policy = os.sched_getscheduler(0)
                self._set(os.SCHED_OTHER, _SLACK_NS)

    def _set(self, policy: int, slack_ns: int) -> None:
        priority = os.sched_param(os.sched_get_priority_min(policy))
        for thread in self._threads:
            with suppress(OSError):
                os.sched_setscheduler(thread, policy, priority)
            _set_slack(thread, slack_ns)


def _set_slack(thread: int, slack_ns: int) -> bool:
    """Whether the system allows it: it asks for `CAP_SYS_NICE`, also of threads of one's own process."""
    with suppress(OSError):
        Path(f"/proc/{thread}/timerslack_ns").write_text(str(slack_ns))
        return True
    return False


def _tasks() -> set[int]:
    with suppress(OSError):
        return {int(task.name) for task in _TASKS.iterdir()}
    return set()
