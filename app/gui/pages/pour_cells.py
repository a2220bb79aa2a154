"""A grid of pours as the map takes it, for every page that shows one."""

from __future__ import annotations

from app.gui.views.pour_map import MappedPour
from core.imagination.results import PourGrid
from core.imagination.risk.result import PourRisk
from core.motion.pour.feasibility import PourMotions


def pour_cells(grid: PourGrid, risk: PourRisk | None, motions: PourMotions | None) -> list[MappedPour]:
    """Return a grid's pours, with what further trials found and which of them an arm can make, if known."""
    p, spread, has_spread = grid.p, grid.p_spread, grid.n_in.shape[2] > 1
    clean = None if risk is None else risk.clean_at_least
    cells = []
    for i, theta_rad in enumerate(grid.theta_rad):
        for j, indent_m in enumerate(grid.indent_m):
            found = None if motions is None else motions.at(i, j)
            cells.append(
                MappedPour(
                    i,
                    j,
                    float(theta_rad),
                    float(indent_m),
                    float(p[i, j]),
                    float(spread[i, j]) if has_spread else None,
                    None if found is None else found.is_feasible,
                    "" if found is None else found.reason,
                    None if clean is None else float(clean[i, j]),
                    0 if risk is None else int(risk.n_tries[i, j]),
                )
            )
    return cells
