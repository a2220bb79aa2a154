"""The shipped simulated cell, and boxes that stand for objects on its platform."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from core.imagination.pours import indentations_m, pivots_m, pour_directions_rad
from core.imagination.results import Footprint
from core.motion.pour.cell import PourCell
from core.motion.pour.checking import check_plan
from core.motion.pour.plan import PlannedMove, PourPlan, PourTarget
from core.motion.pour.planning import plan_pour
from core.motion.trajectory import SAMPLE_S, JointTrajectory
from core.parameters.imagination import PouringParameters
from hardware.cell import read_cell
from hardware.cell.scene import pour_cell

POURING = PouringParameters()
PLATFORM_M = 0.08
BOXES = {
    "mug": ((-0.10, -0.39, PLATFORM_M), (0.00, -0.29, 0.18)),
    "bowl": ((-0.13, -0.44, PLATFORM_M), (0.03, -0.28, 0.135)),
    "basket": ((-0.25, -0.51, PLATFORM_M), (0.13, -0.19, 0.27)),
    "glass": ((-0.02, -0.42, PLATFORM_M), (0.05, -0.35, 0.25)),
}


def shipped_cell(**changes: Any) -> PourCell:
    return replace(pour_cell(read_cell()), **changes)


def cell_with_limits(**limits: float) -> PourCell:
    cell = shipped_cell()
    return replace(cell, limits=cell.limits.model_copy(update=limits))


def box_m(name: str) -> np.ndarray:
    return np.array(BOXES[name])


def pours_onto(box: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (8,) and pivots (8, 3, 3) for a footprint in the middle of a box."""
    middle = box.mean(axis=0)
    footprint = Footprint(np.array([*middle[:2], box[1, 2] + POURING.pivot_height_m]), 0.0, np.zeros(2))
    thetas = pour_directions_rad(footprint, POURING)
    return thetas, pivots_m(footprint, thetas, indentations_m(box, POURING))


def target_of(box: np.ndarray, i: int, j: int) -> PourTarget:
    thetas, pivots = pours_onto(box)
    return PourTarget(box, i, j, float(thetas[i]), pivots[i, j], POURING)


@dataclass(frozen=True)
class Planned:
    """A plan with everything that it was made for."""

    cell: PourCell
    target: PourTarget
    plan: PourPlan

    def check(self, plan: PourPlan | None = None, cell: PourCell | None = None, **changes: Any) -> None:
        """Check a plan, or this one, for this cell and target or changed ones."""
        check_plan(cell or self.cell, replace(self.target, **changes), plan or self.plan)

    def move(self, name: str) -> PlannedMove:
        return next(move for move in self.plan.moves if move.name == name)


def planned(name: str, i: int, j: int, cell: PourCell | None = None, start: Any = None) -> Planned:
    cell, target = cell or shipped_cell(), target_of(box_m(name), i, j)
    start_rad = cell.home_rad if start is None else np.asarray(start)
    return Planned(cell, target, plan_pour(cell, target, start_rad))


def with_move(plan: PourPlan, name: str, joints_rad: np.ndarray) -> PourPlan:
    """The plan with other samples in one of its moves."""
    trajectory = JointTrajectory(SAMPLE_S * np.arange(len(joints_rad)), joints_rad)
    moves = [replace(move, trajectory=trajectory) if move.name == name else move for move in plan.moves]
    return replace(plan, moves=tuple(moves))
