"""What a pour tells on its way, in the words of the moves that were planned."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from app.jobs.arm_news import MoveProgress
from app.jobs.face import JobFace
from core.progress import Reporter

if TYPE_CHECKING:
    from core.motion.pour.plan import PlannedMove

_MOST_OFTEN_S = 0.05
_PACE_AFTER_S = 1.0
"""Before that, the pace is the planned one."""

PivotOff = Callable[[str], float | None]
"""How far the pivot is from its place in a move of this name, in metres."""


class MoveTeller(Reporter):
    """A reporter for moves: passes on to the face of the job that makes them."""

    def __init__(self) -> None:
        super().__init__()
        self._face: JobFace | None = None
        self._names: list[str] = []
        self._durations_s: list[float] = []
        self._begins_s: list[float] = []
        self._pivot_off: PivotOff = lambda _: None
        self._began_s = self._told_s = 0.0

    def begin(self, face: JobFace, moves: Sequence[PlannedMove], pivot_off: PivotOff) -> None:
        """Tell a job's face of these moves from now on."""
        self._face, self._pivot_off = face, pivot_off
        self._names = [move.name for move in moves]
        self._durations_s = [move.trajectory.duration_s for move in moves]
        self._begins_s = [sum(self._durations_s[:k]) for k in range(len(moves))]
        self._began_s, self._told_s = time.monotonic(), 0.0

    def progress(self, stage: str, done: float, total: float) -> None:
        """Tell how many of the planned seconds are done, and of which move."""
        if self._face is None:
            return
        self._face.progress(stage, done, total)
        now_s = time.monotonic()
        if now_s - self._told_s < _MOST_OFTEN_S:
            return
        self._told_s = now_s
        k = max(bisect_right(self._begins_s, done + 1e-9) - 1, 0)
        fraction = min((done - self._begins_s[k]) / self._durations_s[k], 1.0)
        left_s = (total - done) / self._pace(done, now_s)
        name = self._names[k]
        self._face.tell(MoveProgress(k, name, fraction, done, left_s, self._pivot_off(name)))

    def warn(self, sentence: str) -> None:
        """Pass it on."""
        if self._face is not None:
            self._face.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Raise `Cancelled` if somebody asked the job to stop."""
        if self._face is not None:
            self._face.raise_if_cancelled()

    def _pace(self, done_s: float, now_s: float) -> float:
        """Planned seconds in a second: above 1 in a hurried simulation, below with the slider down."""
        spent_s = now_s - self._began_s
        return max(done_s / spent_s, 1e-3) if spent_s > _PACE_AFTER_S and done_s > 0 else 1.0
