"""The answer of an imagination: the JSON of the command-line contract, and in words."""

from __future__ import annotations

from math import degrees
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
        "n_pour": parameters.pouring.n_pour,
        "p": None if grid is None else grid.p.tolist(),
        "p_spread": None if grid is None else grid.p_spread.tolist(),
        "choice": None if result.choice is None else result.choice.to_table(),
        "seconds": {"containability": result.containability_s, "pouring": result.pouring_s},
        "seed": parameters.seed,
        "parameters": flatten(parameters),
    }


def verdict_lines(result: Imagination) -> list[str]:
    """Return the verdict and the chosen pour as sentences."""
    found = result.containability
    verdict = "Open container" if found.is_open_container else "Not an open container"
    lines = [
        f"{verdict}: {found.n_in} of {found.n_drop} candies stayed "
        f"(Omega {found.omega:.3f}, the threshold is {found.omega_threshold:.2f})."
    ]
    if result.grid is not None and result.choice is not None:
        i, j = result.choice.i, result.choice.j
        p, spread = result.grid.p[i, j], result.grid.p_spread[i, j]
        lines.append(
            f"Pour from direction {i} ({degrees(result.choice.theta_rad):.0f} degrees), "
            f"{100 * result.grid.indent_m[j]:.1f} cm from the footprint's centre: "
            f"{100 * p:.0f} +- {100 * spread:.0f} % of {result.grid.n_pour} candies land inside."
        )
    return lines
