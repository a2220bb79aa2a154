"""The pour to plan, and its plan: frozen, and able to save and load itself."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.errors import SessionError
from core.files import read_arrays, read_json, reason, write_arrays, write_json
from core.geometry import AnyArray, FloatArray
from core.motion.trajectory import JointTrajectory
from core.parameters.imagination import PouringParameters

PLAN_FILE, TRAJECTORIES_FILE = "plan.json", "plan.npz"


class Segment(str, Enum):
    """A segment of a pour's motion, from rest to rest; the values are those of the files of sessions."""

    TO_CUP = "to the cup"
    GRASP = "grasp"
    LIFT = "lift"
    CARRY = "carry"
    TILT = "lay"
    LOWER = "lower"
    POUR = "pour"
    ROTATE_BACK = "turn back"
    RAISE = "raise"
    TILT_BACK = "stand up"
    CARRY_BACK = "carry back"
    PUT_DOWN = "put down"
    RETREAT = "retreat"
    HOME = "home"
    LET_GO = "let go of the cup"
    REJOIN = "back on the way"

    def __str__(self) -> str:
        """The value, so that it reads the same in a file, a table and a sentence on every Python."""
        return self.value

    @property
    def label(self) -> str:
        """As shown to the user."""
        return _LABELS.get(self, self.value)

    @property
    def is_over_the_object(self) -> bool:
        """Whether the cup is over the object, or close to it, while it lasts."""
        return self in _OVER_THE_OBJECT


_OVER_THE_OBJECT = (
    Segment.TILT,
    Segment.LOWER,
    Segment.POUR,
    Segment.ROTATE_BACK,
    Segment.RAISE,
    Segment.TILT_BACK,
)
_LABELS = {
    Segment.TILT: "tilt",
    Segment.ROTATE_BACK: "rotate back",
    Segment.TILT_BACK: "tilt upright",
    Segment.REJOIN: "return to the path",
}


class MovePhase(str, Enum):
    """What a move is for."""

    APPROACH = "approach"
    CARRY = "carry"
    POUR = "pour"
    BACK = "back"


GripperAction = Literal["close", "open"]
MoveFacts = tuple[Segment, MovePhase, bool, GripperAction | None]

MOVES: tuple[MoveFacts, ...] = (
    (Segment.TO_CUP, MovePhase.APPROACH, False, None),
    (Segment.GRASP, MovePhase.APPROACH, False, "close"),
    (Segment.LIFT, MovePhase.CARRY, True, None),
    (Segment.CARRY, MovePhase.CARRY, True, None),
    (Segment.TILT, MovePhase.CARRY, True, None),
    (Segment.LOWER, MovePhase.CARRY, True, None),
    (Segment.POUR, MovePhase.POUR, True, None),
    (Segment.ROTATE_BACK, MovePhase.BACK, True, None),
    (Segment.RAISE, MovePhase.BACK, True, None),
    (Segment.TILT_BACK, MovePhase.BACK, True, None),
    (Segment.CARRY_BACK, MovePhase.BACK, True, None),
    (Segment.PUT_DOWN, MovePhase.BACK, True, "open"),
    (Segment.RETREAT, MovePhase.BACK, False, None),
    (Segment.HOME, MovePhase.BACK, False, None),
)
"""Segment, phase, whether the hand holds the cup, and what the gripper does afterwards, in order."""


@dataclass(frozen=True)
class PlannedMove:
    """One move of a plan, from rest to rest.

    Attributes:
        name: its segment of the motion.
        phase: what it is for.
        trajectory: the joints' positions, every 8 ms.
        holds_cup: whether the cup is in the hand.
        gripper_after: what the gripper does when the arm has come to rest.
    """

    name: Segment
    phase: MovePhase
    trajectory: JointTrajectory
    holds_cup: bool
    gripper_after: GripperAction | None

    @property
    def label(self) -> str:
        """As shown to the user."""
        return self.name.label


def is_reversed(move: PlannedMove) -> bool:
    """Whether a plan has its move out with the same samples in reverse; home is reached from elsewhere."""
    return move.phase is MovePhase.BACK and move.name is not Segment.HOME


@dataclass(frozen=True)
class PourTarget:
    """The pour to plan: what was imagined, and chosen.

    Attributes:
        object_aabb_m: (2, 3) lower and upper corner of the object in the base frame.
        i: index of the direction.
        j: index of the distance.
        theta_rad: direction of the ray from p_E to the pivot, against the base frame's x-axis.
        pivot_m: (3,) r_pivot in the base frame.
        pouring: what was imagined with: the cup and its pour rotation.
        digest: of the imagination it belongs to; empty if only its feasibility is judged.
        note: why it is this one, if a person chose it; logged with the run.
    """

    object_aabb_m: FloatArray
    i: int
    j: int
    theta_rad: float
    pivot_m: FloatArray
    pouring: PouringParameters
    digest: str = ""
    note: str = ""


@dataclass(frozen=True)
class PourPlan:
    """Everything the arm does for one pour, checked sample by sample.

    Attributes:
        i: index of the pour's direction.
        j: index of its distance.
        moves: in their order, each starting where the previous one ends.
        T_grasp_cup: (4, 4) pose of the cup in the hand; its x-axis points to the pivot.
        clearance_m: smallest distance of arm and tools to anything.
        nearest: names of the two that are this close.
        cup_clearance_m: smallest distance of the held cup to anything but what it stands on.
        pivot_error_m: largest displacement of the pivot during the pour rotation.
        singularity: smallest `singularity_measure` while the cup is in the hand.
        imagined_turn_s: duration of the imagined pour rotation.
        turn_s: duration of the arm's.
    """

    i: int
    j: int
    moves: tuple[PlannedMove, ...]
    T_grasp_cup: FloatArray
    clearance_m: float
    nearest: tuple[str, str]
    cup_clearance_m: float
    pivot_error_m: float
    singularity: float
    imagined_turn_s: float
    turn_s: float

    @property
    def duration_s(self) -> float:
        """Of all moves, without the gripper's own time."""
        return sum(move.trajectory.duration_s for move in self.moves)

    @property
    def start_rad(self) -> FloatArray:
        """(6,) where the arm must be at the start."""
        return self.moves[0].trajectory.start_rad

    @property
    def digest(self) -> str:
        """SHA-256 of the whole plan, in hexadecimal digits."""
        sha = hashlib.sha256(json.dumps(self._table(), sort_keys=True).encode())
        for name, array in sorted(self._arrays().items()):
            sha.update(f"{name} {array.shape}".encode())
            sha.update(np.ascontiguousarray(array, dtype="<f8").tobytes())
        return sha.hexdigest()

    def save(self, folder: Path) -> None:
        """Write `plan.json` and `plan.npz`."""
        write_arrays(folder / TRAJECTORIES_FILE, **self._arrays())
        write_json(folder / PLAN_FILE, {**self._table(), "digest": self.digest})

    @classmethod
    def load(cls, folder: Path) -> PourPlan:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged, or the two do not belong together.
        """
        table, arrays = read_json(folder / PLAN_FILE), read_arrays(folder / TRAJECTORIES_FILE)
        try:
            plan = cls._from(table, arrays)
            digest = plan.digest
        except (LookupError, TypeError, ValueError) as error:
            raise SessionError(
                f"{folder / PLAN_FILE} is not a valid plan ({reason(error)}); plan the pour again."
            ) from error
        if digest != table.get("digest"):
            raise SessionError(f"The plan in {folder} was changed after it was written; plan the pour again.")
        return plan

    @classmethod
    def _from(cls, table: dict[str, Any], arrays: dict[str, AnyArray]) -> PourPlan:
        moves = tuple(
            PlannedMove(
                Segment(move["name"]),
                MovePhase(move["phase"]),
                JointTrajectory(arrays[f"times_s_{k}"], arrays[f"joints_rad_{k}"]),
                move["holds_cup"],
                move["gripper_after"],
            )
            for k, move in enumerate(table["moves"])
        )
        figures = {name: table[name] for name in _FIGURES}
        nearest = (str(table["nearest"][0]), str(table["nearest"][1]))
        return cls(moves=moves, T_grasp_cup=arrays["T_grasp_cup"], nearest=nearest, **figures)

    def _table(self) -> dict[str, Any]:
        moves = [
            {
                "name": move.name.value,
                "phase": move.phase.value,
                "duration_s": move.trajectory.duration_s,
                "holds_cup": move.holds_cup,
                "gripper_after": move.gripper_after,
            }
            for move in self.moves
        ]
        figures = {name: getattr(self, name) for name in _FIGURES}
        return {**figures, "nearest": list(self.nearest), "moves": moves}

    def _arrays(self) -> dict[str, FloatArray]:
        arrays = {"T_grasp_cup": self.T_grasp_cup}
        for k, move in enumerate(self.moves):
            arrays[f"times_s_{k}"] = move.trajectory.times_s
            arrays[f"joints_rad_{k}"] = move.trajectory.joints_rad
        return arrays


_FIGURES = (
    "i",
    "j",
    "clearance_m",
    "cup_clearance_m",
    "pivot_error_m",
    "singularity",
    "imagined_turn_s",
    "turn_s",
)
