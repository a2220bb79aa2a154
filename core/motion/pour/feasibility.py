"""Which of the imagined pours the arm can make, and the surest among them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_json, write_json
from core.geometry import BoolArray
from core.imagination.results import PourChoice, PourGrid
from core.imagination.risk.result import RISK_FILE, PourRisk

MOTION_FILE = "motion.json"


@dataclass(frozen=True)
class PourFeasibility:
    """Whether the arm can make a pour.

    Attributes:
        i: index of the pour's direction.
        j: index of its distance.
        is_feasible: whether there is a plan that passes every check.
        reason: why not, in a sentence; empty where there is a plan.
        clearance_m: the plan's smallest distance of arm and tools to anything; 0 without a plan.
        turn_s: duration of its pour rotation; 0 without a plan.
        duration_s: of all its moves; 0 without a plan.
    """

    i: int
    j: int
    is_feasible: bool
    reason: str
    clearance_m: float
    turn_s: float
    duration_s: float


@dataclass(frozen=True)
class PourMotions:
    """Which imagined pours the arm can make, and which one it should.

    Attributes:
        pours: all of them, direction by direction.
        choice: the one to make; none if the arm can make none.
        free_choice: what the imagination alone would choose, feasible or not.
        risk: of the pours, with further tries among those that the arm can make; none if it can make
            `free_choice`, or no tries were requested.
    """

    pours: tuple[PourFeasibility, ...]
    choice: PourChoice | None
    free_choice: PourChoice
    risk: PourRisk | None

    @property
    def n_feasible(self) -> int:
        """How many pours the arm can make."""
        return sum(pour.is_feasible for pour in self.pours)

    @property
    def is_changed(self) -> bool:
        """Whether the arm's reach changed the choice of the imagination."""
        choice, free = self.choice, self.free_choice
        return choice is None or (choice.i, choice.j) != (free.i, free.j)

    def at(self, i: int, j: int) -> PourFeasibility:
        """Return the feasibility of one pour."""
        return next(pour for pour in self.pours if (pour.i, pour.j) == (i, j))

    def save(self, folder: Path) -> None:
        """Write `motion.json`, and `risk.json` if there were further tries."""
        table: dict[str, Any] = {
            "pours": [asdict(pour) for pour in self.pours],
            "choice": None if self.choice is None else self.choice.to_table(),
            "free_choice": self.free_choice.to_table(),
        }
        write_json(folder / MOTION_FILE, table)
        if self.risk is not None:
            self.risk.save(folder)

    @classmethod
    def load(cls, folder: Path) -> PourMotions:
        """Read what `save` wrote."""
        table = read_json(folder / MOTION_FILE)
        choice = table["choice"]
        return cls(
            tuple(PourFeasibility(**pour) for pour in table["pours"]),
            None if choice is None else PourChoice.from_table(choice),
            PourChoice.from_table(table.get("free_choice") or table["paper_choice"]),  # its former name
            PourRisk.load(folder) if (folder / RISK_FILE).is_file() else None,
        )


def feasible_pours(pours: tuple[PourFeasibility, ...], grid: PourGrid) -> BoolArray:
    """Return (I, 3) which pours the arm can make."""
    feasible = np.zeros(grid.n_in.shape[:2], dtype=bool)
    for pour in pours:
        feasible[pour.i, pour.j] = pour.is_feasible
    return feasible
