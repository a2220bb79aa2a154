"""Events of an arm in a host process, whether it scans or pours."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from app.jobs.messages import Status

if TYPE_CHECKING:
    from core.geometry import FloatArray
    from core.motion.pour.plan import PlannedMove, PourPlan, Segment
    from hardware.interfaces import ReadyStep, RobotState


@dataclass(frozen=True)
class StepPending:
    """The arm could not be connected before this is done; connecting again with it does it first.

    Attributes:
        step: what has to be done.
        sentence: what is the case.
    """

    step: ReadyStep
    sentence: str


@dataclass(frozen=True)
class ArmConnected:
    """An arm can be used.

    Attributes:
        name: what people call it.
        stop_address: of the controller, whose dashboard accepts a stop; none for an arm in the same process.
        is_simulated: whether nothing real moves.
        pid: of the process that holds it.
    """

    name: str
    stop_address: str | None
    is_simulated: bool
    pid: int = field(default_factory=os.getpid)


@dataclass(frozen=True)
class ArmStatus(Status):
    """The state of an arm, about ten times a second while it is connected.

    Attributes:
        state: the newest; none if it does not answer.
        is_gripper_closed: as read back; none if that is not known.
        problem: a sentence, if it cannot be used as it is; empty if it can.
        stopped_in: the move in which a run was stopped midway; none if none was.
        is_holding: whether the gripper holds something; none where it does not report that.
        grip_width_m: between its fingers; none where it does not report that.
    """

    state: RobotState | None
    is_gripper_closed: bool | None
    problem: str
    stopped_in: Segment | None = None
    is_holding: bool | None = None
    grip_width_m: float | None = None

    @property
    def must_back_off(self) -> bool:
        """Whether a run was stopped midway, so that the arm has to back off first."""
        return self.stopped_in is not None


@dataclass(frozen=True)
class ArmDisconnected:
    """The arm is not connected any more; a sentence if nobody asked for that."""

    sentence: str = ""


@dataclass(frozen=True)
class StopDone:
    """STOP was carried out, or not: the sentence says why not.

    Attributes:
        seconds: from the press until it was confirmed.
        sentence: empty if the arm was stopped.
    """

    seconds: float
    sentence: str = ""


@dataclass(frozen=True)
class MoveProgress(Status):
    """How far the arm is with its moves.

    Attributes:
        index: of the current move.
        name: of that move.
        fraction: of that move, 0 to 1.
        done_s: how much of the planned time is behind it, from the first move on.
        left_s: how long the rest will take, at the speed so far.
        pivot_off_m: how far the pivot is from its place; none except while the cup rotates to pour.
    """

    index: int
    name: str
    fraction: float
    done_s: float
    left_s: float
    pivot_off_m: float | None


@dataclass(frozen=True)
class PlannedPour:
    """A pour that was planned from where the arm is, to be shown before it is confirmed.

    Attributes:
        number: names it in the confirmation.
        plan: the moves, and their clearance.
        note: why it is this pour, in sentences.
        advice: why it should rather not be made; empty if nothing speaks against it.
        expires_s: `time.monotonic` after which it cannot be executed any more.
        pivot_m: (3,) r_pivot.
        T_flange_cup: (4, 4) the cup in the hand.
        mouth_m: (N, 3) the path of the middle of the cup's mouth.
    """

    number: int
    plan: PourPlan
    note: str
    advice: str
    expires_s: float
    pivot_m: FloatArray
    T_flange_cup: FloatArray
    mouth_m: FloatArray


@dataclass(frozen=True)
class PlannedBackOff:
    """The path back after a stop; see `PlannedPour`."""

    number: int
    moves: tuple[PlannedMove, ...]
    T_flange_cup: FloatArray
    mouth_m: FloatArray
