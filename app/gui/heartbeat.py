"""How long the window's event loop was ever kept from its work."""

from __future__ import annotations

import time

from PySide6.QtCore import QObject, Qt, QTimer

BEAT_MS = 10


class Heartbeat(QObject):
    """A timer that notices when it comes late.

    Attributes:
        worst_s: the longest stall since the last `reset`.
        worst_at_s: when it ended, in seconds since the last `reset`.
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
        self.worst_s = 0.0
        self.worst_at_s = 0.0
        self._began_s = self._last_s = time.perf_counter()

    def _beat(self) -> None:
        now_s = time.perf_counter()
        stall_s = now_s - self._last_s - BEAT_MS / 1000
        if stall_s > self.worst_s:
            self.worst_s, self.worst_at_s = stall_s, now_s - self._began_s
        self._last_s = now_s
