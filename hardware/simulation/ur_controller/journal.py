"""What the controller received and did, for tests and people to look at; bounded in memory."""

from __future__ import annotations

from collections import Counter, deque
from typing import Any

_MAX_ENTRIES = 2000


class Journal:
    """The newest entries, and how often each kind of thing happened since the start.

    Attributes:
        counts: by what happened, for example "connection rtde" or "command 1".
    """

    def __init__(self) -> None:
        """Begin empty."""
        self.counts: Counter[str] = Counter()
        self._entries: deque[dict[str, Any]] = deque(maxlen=_MAX_ENTRIES)
        self._now_s = 0.0

    def set_time(self, controller_s: float) -> None:
        """Set the controller's time, which the entries carry."""
        self._now_s = controller_s

    def note(self, what: str, **details: Any) -> None:
        """Count something and record it with its details."""
        self.counts[what] += 1
        self._entries.append({"time_s": round(self._now_s, 4), "what": what, **details})

    def newest(self, number: int) -> list[dict[str, Any]]:
        """Return the last entries, oldest first."""
        return list(self._entries)[-number:]
