"""A planned motion as it is shown: where the arm and the cup are at each time of it. Knows no widgets."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication

from app.jobs.arm_events import PlannedBackOff, PlannedPour
from core.geometry import FloatArray
from core.motion.pour.plan import Segment


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
    """Moves one after the other, of a pour or of the return after a stop.

    Attributes:
        moves: in their order.
        begins_s: when each begins.
        duration_s: of all of them.
        T_flange_cup: (4, 4) the cup in the hand.
        mouth_m: (N, 3) the path of the cup's mouth.
        pivot_m: (3,) r_pivot; none on a return.
        pours_s: when the cup begins to rotate about its rim, and when it has; both the end on a return.
    """

    def __init__(self, planned: PlannedPour | PlannedBackOff) -> None:
        self.moves = planned.plan.moves if isinstance(planned, PlannedPour) else planned.moves
        durations_s = [move.trajectory.duration_s for move in self.moves]
        self.begins_s = [sum(durations_s[:k]) for k in range(len(durations_s))]
        self.duration_s = sum(durations_s)
        self.T_flange_cup = planned.T_flange_cup
        self.mouth_m = planned.mouth_m
        self.pivot_m = planned.pivot_m if isinstance(planned, PlannedPour) else None
        self.pours_s = self.duration_s, self.duration_s
        for move, begin_s, lasts_s in zip(self.moves, self.begins_s, durations_s, strict=True):
            if move.name is Segment.POUR:
                self.pours_s = begin_s, begin_s + lasts_s

    def at(self, time_s: float) -> Moment:
        """Where everything is at a time; the ends before and after."""
        k = max(bisect_right(self.begins_s, time_s) - 1, 0)
        move = self.moves[k]
        return Moment(k, move.trajectory.at(time_s - self.begins_s[k]), move.holds_cup)


def move_text(segment: Segment) -> str:
    """Return a segment's name and what the arm does in it."""
    translate = QCoreApplication.translate
    does = {
        Segment.TO_CUP: translate("Move", "the open gripper goes to the cup"),
        Segment.GRASP: translate("Move", "the gripper closes around the cup"),
        Segment.LIFT: translate("Move", "the cup is lifted straight up"),
        Segment.CARRY: translate("Move", "the cup is carried upright"),
        Segment.TILT: translate("Move", "the cup is tilted over the object"),
        Segment.LOWER: translate("Move", "the cup's rim comes down to the pivot"),
        Segment.POUR: translate("Move", "the cup rotates about its rim and pours"),
        Segment.ROTATE_BACK: translate("Move", "the cup rotates back"),
        Segment.RAISE: translate("Move", "the cup is raised"),
        Segment.TILT_BACK: translate("Move", "the cup is brought upright"),
        Segment.CARRY_BACK: translate("Move", "the cup is carried back"),
        Segment.PUT_DOWN: translate("Move", "the cup is put down and the gripper opens"),
        Segment.RETREAT: translate("Move", "the gripper leaves the cup"),
        Segment.HOME: translate("Move", "the arm goes home"),
        Segment.LET_GO: translate("Move", "the gripper opens and lets go of the cup"),
        Segment.REJOIN: translate("Move", "the arm returns to its checked path"),
    }
    return f"{segment.label}: {does[segment]}"
