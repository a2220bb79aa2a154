"""What is planned for a connected arm: as it is shown, and what refuses it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.jobs.arm_news import PlannedBackOff, PlannedPour
from app.jobs.session_work import SessionTask
from core.errors import MotionError, StageError
from core.geometry import FloatArray, make_pose
from core.imagination.cup import pivot_in_cup_m
from core.motion.kinematics import flange_pose
from core.pipeline.needs import Freshness, freshness
from core.session.operator_choice import read_operator_choice
from hardware.pouring.measuring import TURN

if TYPE_CHECKING:
    from app.jobs.held_arm import HeldArm
    from app.jobs.move_teller import PivotOff
    from core.motion.pour.plan import PlannedMove
    from core.pipeline.pipeline import Pipeline
    from hardware.pouring.pouring import FreshPlan, Pouring, PourTarget

CONFIRMED_FOR_S = 3.0
"""A confirmation that is older does not count: nothing moves at a moment when nobody expects it."""
_EVERY = 8
"""Of the samples of a way as many are shown."""


@dataclass(frozen=True)
class Offer:
    """What was planned and shown, and waits to be confirmed; it is carried out once at most.

    Attributes:
        number: names it in the confirmation.
        task: the session it belongs to.
        pouring: that carries it out.
        fresh: the plan of a pour; none if it is a way back.
        back: the moves of a way back.
        T_flange_cup: (4, 4) the cup in the hand.
    """

    number: int
    task: SessionTask
    pouring: Pouring
    fresh: FreshPlan | None
    back: tuple[PlannedMove, ...]
    T_flange_cup: FloatArray


def shown_pour(offer: Offer, fresh: FreshPlan, note: str, held: HeldArm) -> PlannedPour:
    """Return a planned pour as the page shows it."""
    return PlannedPour(
        offer.number,
        fresh.plan,
        note,
        fresh.made_s + held.arm.settings.motion.expires_s,
        fresh.target.pivot_m,
        offer.T_flange_cup,
        _mouth_way_m(fresh.plan.moves, offer.T_flange_cup, fresh.target.pouring.cup.length_m, held),
    )


def shown_back_off(offer: Offer, held: HeldArm) -> PlannedBackOff:
    """Return a planned way back as the page shows it."""
    length_m = offer.task.parameters.pouring.cup.length_m
    way_m = _mouth_way_m(offer.back, offer.T_flange_cup, length_m, held)
    return PlannedBackOff(offer.number, offer.back, offer.T_flange_cup, way_m)


def pivot_off(held: HeldArm, fresh: FreshPlan, T_flange_cup: FloatArray) -> PivotOff:
    """Return what measures how far the pivot is from its place, by where the joints are."""
    T_flange_pivot = T_flange_cup @ make_pose(np.eye(3), pivot_in_cup_m(fresh.target.pouring.cup))

    def measure(move: str) -> float | None:
        if move != TURN:
            return None
        T_base_pivot = held.arm.robot.state().T_base_flange @ T_flange_pivot
        return float(np.linalg.norm(T_base_pivot[:3, 3] - fresh.target.pivot_m))

    return measure


def refuse_late(confirmed_s: float) -> None:
    """Refuse a confirmation that is not from just now.

    Raises:
        MotionError: it is older than `CONFIRMED_FOR_S`.
    """
    if not 0 <= time.monotonic() - confirmed_s <= CONFIRMED_FOR_S:
        raise MotionError("The confirmation came too late and was not taken; nothing moved. Hold again.")


def refuse_stale(pipeline: Pipeline) -> None:
    """Refuse a session whose pours are not those that its parameters would give.

    Raises:
        StageError: it has to be imagined (again).
    """
    stages = freshness(pipeline.session, pipeline.parameters)
    if any(stages[name] is not Freshness.FRESH for name in ("containability", "pouring")):
        raise StageError("What was imagined is not up to date; imagine again, then plan the pour.")


def refuse_other_target(pipeline: Pipeline, target: PourTarget) -> None:
    """Refuse a plan whose pour is not the chosen one any more.

    Raises:
        MotionError: the object was imagined anew, or somebody chose another pour.
    """
    record = pipeline.session.record("pouring")
    if record is None or record.digest != target.digest:
        raise MotionError("The object was imagined anew since this plan was made; plan anew.")
    chosen = read_operator_choice(pipeline.session.path, record.digest)
    is_same = not target.note if chosen is None else (chosen.i, chosen.j) == (target.i, target.j)
    if not is_same:
        raise MotionError("Another pour was chosen since this plan was made; plan anew.")


def refuse_closed_gripper(held: HeldArm) -> None:
    """Refuse to begin with a closed gripper: it would push the cup over.

    Raises:
        MotionError: it is closed.
        RobotError: the arm does not answer.
    """
    if held.arm.gripper.is_closed:
        raise MotionError("The gripper was closed since this plan was made; open it, then plan anew.")


def _mouth_way_m(
    moves: Sequence[PlannedMove], T_flange_cup: FloatArray, length_m: float, held: HeldArm
) -> FloatArray:
    """The way (N, 3) of the middle of the cup's mouth while the cup is in the hand."""
    from hardware.cell.scene import ARMS

    joints = [move.trajectory.joints_rad[::_EVERY] for move in moves if move.holds_cup]
    if not joints:
        return np.zeros((0, 3))
    flanges = flange_pose(ARMS[held.arm.settings.robot.model], np.concatenate(joints))
    return np.asarray((flanges @ T_flange_cup @ np.array([0.0, 0.0, length_m, 1.0]))[:, :3])
