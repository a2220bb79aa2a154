"""A planned motion as it is shown: where the arm and the cup are at each time of it. Knows no Qt."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.jobs.arm_news import PlannedBackOff, PlannedPour
from core.geometry import FloatArray

if TYPE_CHECKING:
    from core.motion.pour.plan import PlannedMove


@dataclass(frozen=True)
class Moment:
    """The motion at a time.

    Attributes:
        index: of the move.
        joints_rad: (6,).
        holds_cup: whether the cup is in the hand.
    """

    index: int
    joints_rad: FloatArray
    holds_cup: bool


class ShownMotion:
    """Moves one after the other.

    Attributes:
        moves: in their order.
        begins_s: when each begins.
        duration_s: of all of them.
        T_flange_cup: (4, 4) the cup in the hand.
        mouth_m: (N, 3) the way of the cup's mouth.
        pivot_m: (3,) r_pivot; none on a way back.
    """

    def __init__(
        self,
        moves: Sequence[PlannedMove],
        T_flange_cup: FloatArray,
        mouth_m: FloatArray,
        pivot_m: FloatArray | None,
    ) -> None:
        self.moves = tuple(moves)
        durations_s = [move.trajectory.duration_s for move in moves]
        self.begins_s = [sum(durations_s[:k]) for k in range(len(durations_s))]
        self.duration_s = sum(durations_s)
        self.T_flange_cup = T_flange_cup
        self.mouth_m = mouth_m
        self.pivot_m = pivot_m

    @classmethod
    def of_pour(cls, planned: PlannedPour) -> ShownMotion:
        """The motion of a planned pour."""
        return cls(planned.plan.moves, planned.T_flange_cup, planned.mouth_m, planned.pivot_m)

    @classmethod
    def of_way_back(cls, planned: PlannedBackOff) -> ShownMotion:
        """The motion of a planned way back."""
        return cls(planned.moves, planned.T_flange_cup, planned.mouth_m, None)

    def at(self, time_s: float) -> Moment:
        """Where everything is at a time; the ends before and after."""
        k = max(bisect_right(self.begins_s, time_s) - 1, 0)
        move = self.moves[k]
        return Moment(k, move.trajectory.at(time_s - self.begins_s[k]), move.holds_cup)
