"""The search for a pour's motion: how the cup sits in the hand, where it is laid, how it gets there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray
from core.motion.pour.carrying import Carry, Carrying
from core.motion.pour.geometry import laying_grasps, upright_azimuth_rad, upright_rad
from core.motion.pour.lattice import METRE_COST_RAD, Lattice, clear_ways, find_lattice, safe_height_m, why_not
from core.motion.pour.scene import PourScene
from core.motion.pour.station import Grip
from core.motion.pour.turns import CARRY, LAY, NOWHERE, PourTask, Reasons, Turn, find_turns, turn_grasps
from core.parameters.imagination import PouringParameters

_LAY_SHARES = np.linspace(0, 1, 8)
"""Places on the way of laying the cup that are looked at first."""
_LAYS = 24, 120
"""Upright places tried for laying the cup: the first few, and this many if none of them will do."""
_LOWER_M = 0.03
"""The cup is laid at least this far above where the pour begins."""
_LAY_COST_RAD = 8.0
"""Upright places that are farther off than this are not tried."""
_CARRY_SHARE = 0.3
"""What a longer way to there counts against a longer way of laying, where the cup tilts."""


@dataclass(frozen=True)
class Way:
    """Everything that defines a pour's motion but its times.

    Attributes:
        task: the pour.
        turn: how the cup is held.
        grip: how it is taken.
        carry: stretches to where it is laid.
        upright_m: (3,) the tool frame's origin there.
        spin_rad: how far the hand goes round the cup's axis while it lays the cup.
        ready_m: (3,) the tool frame's origin above the beginning of the pour.
        initial_m: (3,) and at its beginning.
    """

    task: PourTask
    turn: Turn
    grip: Grip
    carry: Carry
    upright_m: FloatArray
    spin_rad: float
    ready_m: FloatArray
    initial_m: FloatArray


class WaySearch:
    """Finds ways for the pours onto one object; what several pours ask is answered once."""

    def __init__(self, scene: PourScene, pouring: PouringParameters, grips: Sequence[Grip]) -> None:
        """Search with these ways to take the cup."""
        self.scene = scene
        self.pouring = pouring
        self._grips = grips
        self._lattices: dict[int, Lattice] = {}
        self._carryings: dict[int, list[Carrying]] = {}

    def ways(self, task: PourTask, reasons: Reasons) -> Iterator[Way]:
        """Yield ways that are clear at some places along them, the best first."""
        branches = sorted({grip.branch for grip in self._grips})
        for turn in find_turns(self.scene, self.pouring, task, branches, reasons):
            yield from self._ways_to(task, turn, reasons)

    def _ways_to(self, task: PourTask, turn: Turn, reasons: Reasons) -> Iterator[Way]:
        initial = turn_grasps(self.scene, self.pouring.cup, task, turn.psi_rad, np.zeros(1))[0, :3, 3]
        ready = initial.copy()
        ready[2] = max(ready[2] + _LOWER_M, safe_height_m(self.scene))
        lattice, carryings = self._carried(turn.branch)
        spins = upright_azimuth_rad(task.theta_rad, turn.psi_rad) - lattice.azimuths_rad
        spins = (spins + np.pi) % (2 * np.pi) - np.pi
        for k in self._layable(task, turn, spins, ready, reasons):
            for carrying in carryings:
                carry = carrying.to(k) if np.isfinite(carrying.cost_rad[k]) else None
                if carry is None:
                    reasons.add(CARRY, "The arm found no clear way to carry the upright cup to this pour.")
                    continue
                place, spin = lattice.positions_m[k], float(spins[k])
                yield Way(task, turn, carrying.grip, carry, place, spin, ready, initial)

    def _layable(
        self, task: PourTask, turn: Turn, spins_rad: FloatArray, ready_m: FloatArray, reasons: Reasons
    ) -> Iterator[int]:
        """Upright places from which the cup can be laid above a pour: those of the first batch with any."""
        lattice, carryings = self._carried(turn.branch)
        positions = lattice.positions_m
        cost = np.abs(spins_rad) + METRE_COST_RAD * np.linalg.norm(positions - ready_m, axis=1)
        too_far = cost > _LAY_COST_RAD
        cost += _CARRY_SHARE * np.min([carrying.cost_rad for carrying in carryings], axis=0)
        cost[too_far] = np.inf
        nearest: IntArray = np.argsort(cost, kind="stable")[: _LAYS[1]]
        nearest = nearest[np.isfinite(cost[nearest])]
        if not len(nearest):
            reasons.add(
                NOWHERE, "The arm found no clear way to bring the upright cup anywhere near this pour."
            )
            return
        for batch in (nearest[: _LAYS[0]], nearest[_LAYS[0] :]):
            ways = [
                lay_grasps(self.pouring, task, turn, positions[k], spins_rad[k], ready_m, _LAY_SHARES)
                for k in batch
            ]
            clear = clear_ways(self.scene, turn.branch, np.array(ways).reshape(-1, len(_LAY_SHARES), 4, 4))
            if clear.any():
                yield from batch[clear].tolist()
                return
            if reasons.stage < LAY:
                reasons.add(LAY, why_not(self.scene, turn.branch, ways[0], "lay"))

    def _carried(self, branch: int) -> tuple[Lattice, list[Carrying]]:
        """Where a branch may hold the cup upright, and the ways to there from each of its grips."""
        if branch not in self._lattices:
            lattice = find_lattice(self.scene, branch)
            own = [grip for grip in self._grips if grip.branch == branch]
            self._lattices[branch] = lattice
            self._carryings[branch] = [Carrying(self.scene, grip, lattice) for grip in own]
        return self._lattices[branch], self._carryings[branch]


def lay_grasps(
    pouring: PouringParameters,
    task: PourTask,
    turn: Turn,
    upright_m: FloatArray,
    spin_rad: float,
    ready_m: FloatArray,
    shares: FloatArray,
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at shares (N,) of the way from upright to lying ready."""
    left = 1 - shares
    gammas = upright_rad(pouring.cup) * left
    positions = ready_m + left[:, None] * (upright_m - ready_m)
    return laying_grasps(pouring.cup, task.theta_rad, gammas, turn.psi_rad + spin_rad * left, positions)
