"""What comes next with the arm, by how everything stands. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from app.jobs.arm_news import ArmStatus


class Step(Enum):
    """One thing at a time; the value is the number in the row of steps, 0 where none of them is current."""

    EMPTY = "empty", 0
    CONNECT = "connect", 1
    PLAN = "plan", 2
    CHECK = "check", 3
    POUR = "pour", 4
    OUTCOME = "outcome", 5
    STOPPED = "stopped", 4
    WAY_BACK = "way back", 4
    BACK = "back", 4
    BACKING = "backing", 4

    @property
    def number(self) -> int:
        """Its place among connect, plan, check, pour and outcome."""
        return self.value[1]

    @property
    def is_recovery(self) -> bool:
        """Whether it is about coming back after a stop."""
        return self in (Step.STOPPED, Step.WAY_BACK, Step.BACK)

    @property
    def is_moving(self) -> bool:
        """Whether the arm moves."""
        return self in (Step.POUR, Step.BACKING)


class Doing(Enum):
    """The job with the arm that is under way."""

    NOTHING = "nothing"
    CONNECTING = "connecting"
    PLANNING = "planning"
    POURING = "pouring"
    COUNTING = "counting"
    RECOVERING = "recovering"
    PLANNING_BACK = "planning back"
    BACKING = "backing"
    GRIPPING = "gripping"


@dataclass(frozen=True)
class Situation:
    """How everything stands.

    Attributes:
        doing: the job under way.
        status: of the connected arm; none if none is connected.
        is_connected: whether the cell's arm is.
        is_possible: whether the session holds a pour to be made.
        has_plan: whether a pour was planned.
        has_way: whether the way back was planned.
        has_run: whether a run waits for its outcome.
    """

    doing: Doing
    status: ArmStatus | None
    is_connected: bool
    is_possible: bool
    has_plan: bool
    has_way: bool
    has_run: bool

    @property
    def step(self) -> Step:
        """What comes next; coming back after a stop comes before anything else."""
        if self.doing is Doing.POURING:
            return Step.POUR
        if self.doing is Doing.BACKING:
            return Step.BACKING
        if self.status is not None and self.status.problem:
            return Step.STOPPED
        if self.status is not None and self.status.must_back_off:
            return Step.BACK if self.has_way else Step.WAY_BACK
        if self.has_run:
            return Step.OUTCOME
        if not self.is_possible:
            return Step.EMPTY
        if not self.is_connected:
            return Step.CONNECT
        return Step.CHECK if self.has_plan else Step.PLAN
