"""A plain bowl in place of an object: where an arm can pour at all, before anything was scanned."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.imagination.pours import indentations_m, pivots_m, pour_directions_rad
from core.imagination.results import Footprint
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourFeasibility
from core.motion.pour.plan import PourTarget
from core.motion.pour.planning import judge_pours
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import TaskRunner

BOWL_M = (0.12, 0.12, 0.08)
"""Edges of the box around it."""


@dataclass(frozen=True)
class PourReach:
    """Which pours into the bowl an arm can make.

    Attributes:
        object_aabb_m: (2, 3) lower and upper corner of the bowl's box.
        theta_rad: (I,) directions.
        pivot_m: (I, J, 3) pivots.
        pouring: the cup and its rotation.
        pours: all of them.
    """

    object_aabb_m: FloatArray
    theta_rad: FloatArray
    pivot_m: FloatArray
    pouring: PouringParameters
    pours: tuple[PourFeasibility, ...]

    @property
    def n_sides(self) -> int:
        """How many directions there are."""
        return len(self.theta_rad)

    @property
    def n_reached(self) -> int:
        """From how many of them the arm can pour."""
        return len({pour.i for pour in self.pours if pour.is_feasible})

    @property
    def reason(self) -> str:
        """What is most often in the way; empty if nothing is."""
        reasons = Counter(pour.reason for pour in self.pours if not pour.is_feasible)
        return reasons.most_common(1)[0][0] if reasons else ""

    def target(self, digest: str) -> PourTarget | None:
        """Return the pour that is clearest of everything; none if the arm can make none.

        Args:
            digest: names what it was found for.
        """
        feasible = [pour for pour in self.pours if pour.is_feasible]
        if not feasible:
            return None
        best = max(feasible, key=lambda pour: (round(pour.clearance_m, 4), -pour.duration_s))
        theta_rad, pivot_m = float(self.theta_rad[best.i]), self.pivot_m[best.i, best.j]
        return PourTarget(self.object_aabb_m, best.i, best.j, theta_rad, pivot_m, self.pouring, digest)


def judge_reach(
    cell: PourCell,
    middle_m: Sequence[float] | FloatArray,
    pouring: PouringParameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> PourReach:
    """Plan every pour into a bowl that stands with the middle of its foot at a point (3,), from home.

    Raises:
        MotionError: the cup cannot be taken at its station at all.
        Cancelled: the reporter was asked to stop.
    """
    half = np.array([BOWL_M[0] / 2, BOWL_M[1] / 2, 0.0])
    middle = np.asarray(middle_m, dtype=float)
    aabb_m = np.array([middle - half, middle + half + [0.0, 0.0, BOWL_M[2]]])
    above = np.array([*middle[:2], aabb_m[1, 2] + pouring.pivot_height_m])
    footprint = Footprint(above, 0.0, np.ones(2))
    thetas = pour_directions_rad(footprint, pouring)
    pivots = pivots_m(footprint, thetas, indentations_m(aabb_m, pouring))
    pours = judge_pours(cell, aabb_m, thetas, pivots, pouring, cell.home_rad, runner, reporter)
    return PourReach(aabb_m, thetas, pivots, pouring, pours)
