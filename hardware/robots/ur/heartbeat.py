"""Whether the program that drives the arm still runs, as its worker process sees it."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

from hardware.robots.ur.messages import Pulse

STOOD_STILL_S = 2.0
"""Somebody who suspends a program takes longer; a busy machine may keep it from running for a second."""
BUSY_S = 30.0
"""Of a program that works all the time but is not heard: it hangs, and nobody could stop it."""
_LOOP_S = 0.05
"""Of a pause between two looks no more counts: the process that looks did not run, either."""
_MISSED_S = 0.1
"""A program that is not heard for so long is looked at."""


class Heartbeat:
    """Tells a program that was suspended from one that is busy.

    Its pulse alone does not: a call into a library, such as a compiler or the import of a large one, may
    hold the interpreter for seconds on a busy machine, and no other thread of the program beats meanwhile.
    A suspended program neither uses a processor nor waits for one.
    """

    def __init__(self, pulse: Pulse, process_id: int) -> None:
        """Listen to a program's pulse, and look at its process."""
        self._pulse, self._process_id = pulse, process_id
        self._heard = 0
        self._looked_s = time.monotonic()
        self._unheard_s, self._still_s = 0.0, 0.0
        self._worked_s = 0.0

    def problem(self) -> str:
        """What is wrong with the program; empty if nothing is. To be asked all the time."""
        now_s, heard = time.monotonic(), self._pulse.count
        passed_s, self._looked_s = min(now_s - self._looked_s, _LOOP_S), now_s
        if heard != self._heard or not heard:
            self._heard, self._unheard_s, self._still_s = heard, 0.0, 0.0
            return ""
        before_s, self._unheard_s = self._unheard_s, self._unheard_s + passed_s
        self._still_s += passed_s
        if self._unheard_s > _MISSED_S:
            worked_s = _worked_s(self._process_id)
            if before_s > _MISSED_S:  # what it did until then it did while it was heard
                self._still_s = max(self._still_s - max(worked_s - self._worked_s, 0.0), 0.0)
            self._worked_s = worked_s
        if self._still_s > STOOD_STILL_S:
            return f"This program stood still for {STOOD_STILL_S:g} s or longer"
        return f"This program hung for {BUSY_S:g} s or longer" if self._unheard_s > BUSY_S else ""


def _worked_s(process_id: int) -> float:
    """How long a process's threads have used a processor or waited for one; 0 where the system does not say.

    Source: Linux, Documentation/scheduler/sched-stats.rst, "/proc/<pid>/schedstat".
    """
    total_ns = 0
    with suppress(OSError):
        for task in Path(f"/proc/{process_id}/task").iterdir():
            with suppress(OSError, ValueError):  # it may end meanwhile
                total_ns += sum(map(int, (task / "schedstat").read_text().split()[:2]))
    return total_ns / 1e9
