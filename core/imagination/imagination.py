"""Everything that was imagined of one object, in one frozen piece."""

from __future__ import annotations

from dataclasses import dataclass

from core.imagination.amount.result import Amount, PlannedAmount
from core.imagination.capacity.result import Capacity
from core.imagination.choice import choose_pour
from core.imagination.judgement import Judgement
from core.imagination.results import Containability, Drop, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.imagination.risk.result import PourRisk
from core.imagination.risk.tries import Tries
from core.parameters.bodies import CupParameters

WORKER_MODULE = "core.imagination.preload"
"""What workers import before their first task."""


@dataclass(frozen=True)
class Imagination:
    """Everything imagined of an object; without grid, risk and choice if it is no open container.

    Attributes:
        containability: the drop, with the verdict.
        capacity: what the object holds; none if Omega decides, or nothing stayed in the drop.
        retention: how firmly; none if Omega decides, or nothing stayed in the drop.
        amount: how many candies shall go in, and whether they fit; as `capacity`.
        n_per_cup: candies in each cup to be poured.
        grid: the pours.
        risk: of the pours; none also if no tries were asked for.
        choice: the surest pour, or the paper's if the risk is not known.
        paper_choice: what the paper's rule says.
        containability_s: seconds of the drop and the verdict.
        pouring_s: seconds of the cup's runs, the pours and their tries.
    """

    containability: Containability
    capacity: Capacity | None
    retention: Retention | None
    amount: Amount | None
    n_per_cup: tuple[int, ...]
    grid: PourGrid | None
    risk: PourRisk | None
    choice: PourChoice | None
    paper_choice: PourChoice | None
    containability_s: float
    pouring_s: float

    @classmethod
    def of(
        cls,
        drop: Drop,
        judgement: Judgement,
        planned: PlannedAmount,
        grid: PourGrid | None,
        tries: Tries,
        retention: Retention | None,
        *,
        cup: CupParameters,
        containability_s: float = 0.0,
        pouring_s: float = 0.0,
    ) -> Imagination:
        """Join the results of the stages; `cup` is the one that the pours were imagined with."""
        return cls(
            judgement.of(drop),
            judgement.capacity,
            retention,
            planned.amount,
            planned.n_per_cup,
            grid,
            tries.risk,
            tries.choice,
            None if grid is None else choose_pour(grid, cup),
            containability_s,
            pouring_s,
        )
