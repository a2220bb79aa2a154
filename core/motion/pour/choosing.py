"""Which pour to make with this arm: the surest among those that the arm can make."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_json, write_json
from core.geometry import BoolArray
from core.imagination.results import PourChoice, PourGrid
from core.imagination.risk.results import RISK_FILE, PourRisk
from core.motion.pour.plan import PourFeasibility

MOTION_FILE = "motion.json"


@dataclass(frozen=True)
class PourMotions:
    """What the arm can make of the imagined pours.

    Attributes:
        pours: all of them, direction by direction.
        choice: the one to make; none if the arm can make none.
        free_choice: what the imagination alone would choose, whether or not the arm can make it.
        risk: of the pours, with further tries among those that the arm can make; none if it can make
            `free_choice`, or no tries were asked for.
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
        """Whether the arm decided, and not the imagination alone."""
        choice, free = self.choice, self.free_choice
        return choice is None or (choice.i, choice.j) != (free.i, free.j)

    def at(self, i: int, j: int) -> PourFeasibility:
        """Return what was found of one pour."""
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
