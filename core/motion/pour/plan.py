"""The plan of a pour, and whether a pour can be planned: frozen, and able to save and load themselves."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.errors import SessionError
from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import AnyArray, FloatArray
from core.motion.trajectory import JointTrajectory

PLAN_FILE, TRAJECTORIES_FILE = "plan.json", "plan.npz"


class MovePhase(str, Enum):
    """What a move is for."""

    APPROACH = "approach"
    CARRY = "carry"
    POUR = "pour"
    BACK = "back"


GripperAction = Literal["close", "open"]
MoveFacts = tuple[str, MovePhase, bool, GripperAction | None]

MOVES: tuple[MoveFacts, ...] = (
    ("to the cup", MovePhase.APPROACH, False, None),
    ("grasp", MovePhase.APPROACH, False, "close"),
    ("lift", MovePhase.CARRY, True, None),
    ("carry", MovePhase.CARRY, True, None),
    ("lay", MovePhase.CARRY, True, None),
    ("lower", MovePhase.CARRY, True, None),
    ("pour", MovePhase.POUR, True, None),
    ("turn back", MovePhase.BACK, True, None),
    ("raise", MovePhase.BACK, True, None),
    ("stand up", MovePhase.BACK, True, None),
    ("carry back", MovePhase.BACK, True, None),
    ("put down", MovePhase.BACK, True, "open"),
    ("retreat", MovePhase.BACK, False, None),
    ("home", MovePhase.BACK, False, None),
)
"""Name, phase, whether the hand holds the cup, and what the gripper does afterwards, in their order."""


@dataclass(frozen=True)
class PlannedMove:
    """One move of a plan, from rest to rest.

    Attributes:
        name: for people.
        phase: what it is for.
        trajectory: where the joints are at which time, every 8 ms.
        holds_cup: whether the cup is in the hand.
        gripper_after: what the gripper does when the arm has come to rest.
    """

    name: str
    phase: MovePhase
    trajectory: JointTrajectory
    holds_cup: bool
    gripper_after: GripperAction | None


@dataclass(frozen=True)
class PourPlan:
    """Everything the arm does for one pour, checked sample by sample.

    Attributes:
        i: index of the pour's direction.
        j: index of its distance.
        moves: in their order, each beginning where the one before ends.
        T_grasp_cup: (4, 4) how the cup sits in the hand; its x-axis points to the pivot.
        clearance_m: smallest distance of arm and tools to anything.
        nearest: names of the two that are this near.
        cup_clearance_m: smallest distance of the held cup to anything but what it stands on.
        pivot_error_m: how far the pivot wanders during the turn.
        singularity: smallest `singularity_measure` while the cup is in the hand.
        imagined_turn_s: time of the imagined turn.
        turn_s: time the arm takes for it.
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
        """(6,) where the arm must stand to begin."""
        return self.moves[0].trajectory.start_rad

    @property
    def digest(self) -> str:
        """SHA-256 over everything the plan says, in hexadecimal digits."""
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
            SessionError: a file is missing, damaged, or not the one that was written with the other.
        """
        table, arrays = read_json(folder / PLAN_FILE), read_arrays(folder / TRAJECTORIES_FILE)
        try:
            plan = cls._from(table, arrays)
        except (KeyError, TypeError, ValueError) as error:
            raise SessionError(f"{folder / PLAN_FILE} is no plan ({error}); plan the pour again.") from error
        if plan.digest != table.get("digest"):
            raise SessionError(f"The plan in {folder} was changed after it was written; plan the pour again.")
        return plan

    @classmethod
    def _from(cls, table: dict[str, Any], arrays: dict[str, AnyArray]) -> PourPlan:
        moves = tuple(
            PlannedMove(
                move["name"],
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
                "name": move.name,
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


@dataclass(frozen=True)
class PourFeasibility:
    """Whether the arm can make a pour.

    Attributes:
        i: index of the pour's direction.
        j: index of its distance.
        is_feasible: whether there is a plan that passes every check.
        reason: why not, in a sentence; empty where there is a plan.
        clearance_m: the plan's smallest distance of arm and tools to anything; 0 without a plan.
        turn_s: the time its turn takes; 0 without a plan.
        duration_s: of all its moves; 0 without a plan.
    """

    i: int
    j: int
    is_feasible: bool
    reason: str
    clearance_m: float
    turn_s: float
    duration_s: float
