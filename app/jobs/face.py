"""What a job sees of the program: a reporter that sends everything on."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from app.jobs.messages import Message, News, Progressed, Warned
from core.progress import Reporter

_MOST_OFTEN_S = 0.05


class JobFace(Reporter):
    """Sends progress (at most 20 times a second), warnings and news; made anew for each job."""

    def __init__(self, send: Callable[[Message], None]) -> None:
        super().__init__()
        self._send = send
        self._told_s = 0.0
        self._stage = ""

    def progress(self, stage: str, done: float, total: float) -> None:
        """Send it on, unless the last word on this stage was just before."""
        now_s = time.monotonic()
        if stage == self._stage and done < total and now_s - self._told_s < _MOST_OFTEN_S:
            return
        self._stage, self._told_s = stage, now_s
        self._send(Progressed(stage, done, total))

    def warn(self, sentence: str) -> None:
        """Send it on."""
        self._send(Warned(sentence))

    def tell(self, payload: Any) -> None:
        """Send news: a frozen dataclass that the page of this job knows."""
        self._send(News(payload))
