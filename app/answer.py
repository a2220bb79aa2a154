"""The answer of an imagination as the JSON of the command-line contract."""

from __future__ import annotations

from typing import Any

from core.imagination.imagine import Imagination
from core.parameters import Parameters, flatten


def answer_table(result: Imagination, parameters: Parameters) -> dict[str, Any]:
    """Return what `poursight imagine --json` writes; pours are null when none were imagined."""
    found, grid = result.containability, result.grid
    footprint = found.footprint
    return {
        "omega": found.omega,
        "is_open_container": found.is_open_container,
        "n_drop": found.n_drop,
        "n_in": found.n_in,
        "footprint": None
        if footprint is None
        else {"center_m": footprint.center_m.tolist(), "axis_rad": footprint.axis_rad},
        "verdict": None if found.verdict is None else found.verdict.to_table(),
        "capacity": None if result.capacity is None else result.capacity.to_table(),
        "holding": None if result.holding is None else result.holding.to_table(),
        "n_pour": parameters.pouring.n_pour if grid is None else grid.n_pour,
        "amount": None if result.amount is None else result.amount.to_table(),
        "p": None if grid is None else grid.p.tolist(),
        "p_spread": None if grid is None else grid.p_spread.tolist(),
        "choice": None if result.choice is None else result.choice.to_table(),
        "risk": None if result.risk is None else result.risk.to_table(),
        "paper_choice": None if result.paper_choice is None else result.paper_choice.to_table(),
        "seconds": {"containability": result.containability_s, "pouring": result.pouring_s},
        "seed": parameters.seed,
        "parameters": flatten(parameters),
    }
