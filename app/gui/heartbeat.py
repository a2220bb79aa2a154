"""How long the window's event loop was ever kept from its work."""

from __future__ import annotations

import resource
import time
from pathlib import Path

from PySide6.QtCore import QObject, Qt, QTimer

BEAT_MS = 10
_SCHEDULED = Path("/proc/thread-self/schedstat")
"""Linux: nanoseconds on a processor, nanoseconds ready and waiting for one, times that it ran."""


class Heartbeat(QObject):
    """A timer that notices when it comes late.

    Attributes:
        worst_s: the longest stall since the last `reset`.
        worst_at_s: when it ended, in seconds since the last `reset`.
        worst_own_s: the longest one without the time in which other processes had all processors; where
            something came from the disk, its processor time alone. What is left is the program's doing.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(BEAT_MS)
        self._timer.timeout.connect(self._beat)
        self.reset()
        self._timer.start()

    def reset(self) -> None:
        """Begin anew."""
        self.worst_s = self.worst_at_s = self.worst_own_s = 0.0
        self._began_s = self._last_s = time.perf_counter()
        self._waited_s = _waited_for_processor_s()
        self._busy_s, self._disk = time.process_time(), _times_at_disk()

    def _beat(self) -> None:
        now_s, waited_s = time.perf_counter(), _waited_for_processor_s()
        stall_s = now_s - self._last_s - BEAT_MS / 1000
        if stall_s > self.worst_s:
            self.worst_s, self.worst_at_s = stall_s, now_s - self._began_s
        busy_s, disk = time.process_time(), _times_at_disk()
        own_s = stall_s - (waited_s - self._waited_s)
        if disk != self._disk:
            own_s = min(own_s, busy_s - self._busy_s)
        self.worst_own_s = max(self.worst_own_s, own_s)
        self._last_s, self._waited_s, self._busy_s, self._disk = now_s, waited_s, busy_s, disk


def _times_at_disk() -> tuple[int, int]:
    """How often this process had to wait for the disk so far: pages of libraries, and what it read."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_majflt, used.ru_inblock


def _waited_for_processor_s() -> float:
    """How long this thread was ready to run so far, and something else ran; 0 where nobody counts it."""
    try:
        return int(_SCHEDULED.read_text(encoding="ascii").split()[1]) / 1e9
    except (OSError, IndexError):
        return 0.0
