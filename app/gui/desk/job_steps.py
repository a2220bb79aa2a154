"""How far a job of several steps is and how long it will take; neither figure goes back. No Qt."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

TYPICAL_S = {
    "import": 1.3,
    "reconstruction": 0.8,
    "quality": 0.7,
    "colors": 0.2,
    "collision": 0.1,
    "containability": 1.2,
    "capacity": 1.2,
    "retention": 1.7,
    "pouring": 3.6,
    "risk": 1.3,
    "motion": 1.2,
    "evidence": 6.6,
}
"""Of each step, for a mug on two cores; only their ratios matter once a job has begun."""
_SOONEST = 0.08
"""Share of the work after which a job's own pace is known; earlier, a time left would be a guess."""
_OVERDUE = 1.5
_OVERDUE_S = 5.0
"""Said to take longer than expected: by this factor, and by so many seconds."""


class JobSteps:
    """The steps of one job, in their order.

    Attributes:
        names: the stages that the job is expected to run; a step that is left out is passed over.
        current: of these, the one that runs; none before the first.
    """

    def __init__(self, names: Iterable[str], clock: Callable[[], float] = time.monotonic) -> None:
        self.names = tuple(names)
        self.current: str | None = None
        self._clock = clock
        self._began_s = clock()
        self._done_of_current = 0.0
        self._fraction = 0.0
        self._said_s = float("inf")

    def progress(self, stage: str, fraction: float) -> None:
        """Take a stage's progress, 0 to 1; what belongs to an earlier step, or to none, changes nothing."""
        if stage not in self.names:
            return
        index, now = self.names.index(stage), self._index
        if index < now:
            return
        if index > now:
            self.current, self._done_of_current = stage, 0.0
        self._done_of_current = max(self._done_of_current, min(fraction, 1.0))
        self._fraction = max(self._fraction, self._done_s / max(self._all_s, 1e-9))

    @property
    def fraction(self) -> float:
        """Of the whole job."""
        return self._fraction

    @property
    def is_late(self) -> bool:
        """Whether no time left is said because it would have to go back."""
        return self.seconds_left is None and self._fraction >= _SOONEST

    @property
    def seconds_left(self) -> float | None:
        """Never more than was said before; none at first, and while that turns out to be far too little."""
        if self._fraction < _SOONEST:
            return None
        pace = (self._clock() - self._began_s) / self._done_s
        estimated_s = pace * (self._all_s - self._done_s)
        self._said_s = min(self._said_s, estimated_s)  # a clock that stands is better than one that goes back
        return None if estimated_s > _OVERDUE * self._said_s + _OVERDUE_S else self._said_s

    @property
    def _index(self) -> int:
        return -1 if self.current is None else self.names.index(self.current)

    @property
    def _all_s(self) -> float:
        return sum(map(_typical_s, self.names))

    @property
    def _done_s(self) -> float:
        if self.current is None:
            return 0.0
        before_s = sum(map(_typical_s, self.names[: self._index]))
        return before_s + self._done_of_current * _typical_s(self.current)


def _typical_s(stage: str) -> float:
    return TYPICAL_S.get(stage, 1.0)
