"""Which files of a session hold what was imagined."""

from __future__ import annotations

from pathlib import Path

from core.files import read_json, write_json
from core.imagination.amount.result import AMOUNT_FILE, Amount
from core.imagination.capacity.result import Capacity
from core.imagination.choice import choose_pour
from core.imagination.holding.result import HOLDING_FILE, Holding
from core.imagination.imagine import Imagination
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import RISK_FILE, PourRisk
from core.parameters.imagination import CupParameters

CHOICE_FILE = "choice.json"


def save_containability(result: Imagination, folder: Path) -> None:
    """Write the drop, and what the object holds and how firmly, if that was imagined."""
    result.containability.save(folder)
    for found in (result.capacity, result.holding):
        if found is not None:
            found.save(folder)


def save_pouring(result: Imagination, folder: Path) -> None:
    """Write the pours, their risk, the choice and the amount, as far as there are any."""
    write_json(folder / CHOICE_FILE, {"choice": None if result.choice is None else result.choice.to_table()})
    if result.grid is not None:
        result.grid.save(folder)
    if result.risk is not None:
        result.risk.save(folder)
    if result.amount is not None:
        write_json(folder / AMOUNT_FILE, result.amount.to_table())


def load(
    containability: Path, pouring: Path, cup: CupParameters, containability_s: float, pouring_s: float
) -> Imagination:
    """Read what the two wrote.

    Args:
        containability: the folder of the one.
        pouring: the folder of the other.
        cup: the pours were imagined with.
        containability_s: seconds that the one took.
        pouring_s: seconds that the other took.
    """
    choice = read_json(pouring / CHOICE_FILE)["choice"]
    grid = PourGrid.load(pouring) if choice is not None else None
    is_filled = (containability / HOLDING_FILE).is_file()
    return Imagination(
        Containability.load(containability),
        Capacity.load(containability) if is_filled else None,
        Holding.load(containability) if is_filled else None,
        Amount.from_table(read_json(pouring / AMOUNT_FILE)) if (pouring / AMOUNT_FILE).is_file() else None,
        grid,
        PourRisk.load(pouring) if (pouring / RISK_FILE).is_file() else None,
        PourChoice.from_table(choice) if choice is not None else None,
        None if grid is None else choose_pour(grid, cup),
        containability_s,
        pouring_s,
    )
