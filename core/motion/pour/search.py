"""The search for a pour's motion: how the cup sits in the hand, where it is laid, how it gets there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.inverse_kinematics import inverse_kinematics
from core.motion.kinematics import singularity_measure
from core.motion.pour.carrying import Carry, Carrying
from core.motion.pour.geometry import (
    hand_angle_rad,
    laying_grasps,
    turned_cups,
    upright_azimuth_rad,
    upright_rad,
)
from core.motion.pour.lattice import Lattice, clear_ways, find_lattice, safe_height_m
from core.motion.pour.scene import PourScene, too_near
from core.motion.pour.station import Grip
from core.parameters.imagination import PouringParameters

_STEP_RAD = np.pi / 12
_N_PSI = 24
_TURN_PLACES = 6
_LAY = np.linspace(0, 1, 8)
"""Shares of the way of laying the cup that are looked at first."""
_CLEARLY = " without coming too near to something or to a singular configuration."
_LAYS = 24, 120
"""Places tried for laying the cup: the first few, and this many if none of them will do."""
_LOWER_M = 0.03
"""The cup is laid at least this far above where the pour begins."""
_METRE_COST_RAD = 6.0
"""A way of a metre costs as much as turning the hand by this."""
_LAY_COST_RAD = 8.0
"""Places that are farther off than this are not tried for laying the cup."""
_CARRY_SHARE = 0.3
"""What a longer way to there counts against a longer way of laying, where the cup tilts."""


@dataclass(frozen=True)
class PourTask:
    """One of the imagined pours.

    Attributes:
        i: index of its direction.
        j: index of its distance.
        theta_rad: the direction, against the base frame's x-axis.
        pivot_m: (3,) in the base frame.
    """

    i: int
    j: int
    theta_rad: float
    pivot_m: FloatArray


@dataclass(frozen=True)
class Turn:
    """A way to hold the cup in the pour.

    Attributes:
        psi_rad: how the cup sits in the hand.
        branch: of the inverse kinematics.
    """

    psi_rad: float
    branch: int


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


@dataclass
class Reasons:
    """Why there is no way: the sentence of the attempt that came farthest.

    Attributes:
        stage: how far it came.
        sentence: why it went no farther.
    """

    stage: int = -1
    sentence: str = ""

    def add(self, stage: int, sentence: str) -> None:
        """Keep a sentence if no other attempt came this far."""
        if stage > self.stage:
            self.stage, self.sentence = stage, sentence


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
        for turn in self._turns(task, reasons):
            yield from self._ways_to(task, turn, reasons)

    def _turns(self, task: PourTask, reasons: Reasons) -> list[Turn]:
        """How the cup may be held in the pour: the hand opposite to the pivot first."""
        scene = self.scene
        gammas = np.linspace(0, self.pouring.gamma_0_rad, _TURN_PLACES)
        offsets = _STEP_RAD * np.array([(k + 1) // 2 * (1 if k % 2 else -1) for k in range(_N_PSI)])
        psis = hand_angle_rad(scene.cell.T_flange_grasp) + offsets
        poses = np.concatenate([self._turn_grasps(task, float(psi), gammas) for psi in psis])
        branches = sorted({grip.branch for grip in self._grips})
        result = inverse_kinematics(scene.cell.arm, scene.flange_poses(poses), branches)
        shape = _N_PSI, _TURN_PLACES, len(branches)
        reached = (result.found & ~result.undetermined).reshape(shape).all(axis=1)
        if not reached.any():
            reasons.add(0, "The arm cannot reach this pour with the hand on any side of the cup.")
            return []
        which: IntArray = np.argwhere(reached)
        joints = result.joints_rad.reshape(*shape, 6).transpose(0, 2, 1, 3)[reached]
        fine = self._clear_turns(joints, reasons)
        if not fine.any():
            return []
        return [Turn(float(psis[k]), branches[b]) for k, b in which[fine]]

    def _turn_grasps(self, task: PourTask, psi_rad: float, gammas: FloatArray) -> FloatArray:
        cups = turned_cups(self.pouring.cup, task.pivot_m, task.theta_rad, gammas)
        axis = cups[:, :3, 2] * self.scene.cell.grip_height_m
        psi = np.full(len(gammas), psi_rad)
        return laying_grasps(self.pouring.cup, task.theta_rad, gammas, psi, cups[:, :3, 3] + axis)

    def _clear_turns(self, joints: FloatArray, reasons: Reasons) -> BoolArray:
        """Which turns (C, K, 6) are clear and not singular."""
        scene, limits, shape = self.scene, self.scene.cell.limits, joints.shape[:2]
        bent: BoolArray = singularity_measure(scene.cell.arm, joints).min(axis=1) >= limits.min_singularity
        if not bent.any():
            reasons.add(1, "In the pour the arm would be too near to a singular configuration.")
            return bent
        flat = joints.reshape(-1, 6)
        room = scene.hand.clearance(flat)
        hand = np.where(bent[:, None], room.distance_m.reshape(shape), -1.0)
        fine: BoolArray = hand.min(axis=1) >= limits.min_clearance_m
        if not fine.any():
            best = int(hand.min(axis=1).argmax())
            worst = best * shape[1] + int(hand[best].argmin())
            distance = float(room.distance_m[worst])
            reasons.add(2, too_near("pour", room.nearest(worst), distance, limits.min_clearance_m))
            return fine
        held = joints[fine].reshape(-1, 6)
        cup = scene.cup_clearance(scene.held_cups(held), held)
        around = cup.distance_m.reshape(-1, shape[1]).min(axis=1)
        if around.max() < limits.cup_clearance_m:
            worst = int(around.argmax()) * shape[1]
            worst += int(cup.distance_m[worst : worst + shape[1]].argmin())
            distance = float(cup.distance_m[worst])
            reasons.add(3, too_near("pour", cup.nearest(worst), distance, limits.cup_clearance_m))
        fine[fine] = around >= limits.cup_clearance_m
        return fine

    def _ways_to(self, task: PourTask, turn: Turn, reasons: Reasons) -> Iterator[Way]:
        initial = self._turn_grasps(task, turn.psi_rad, np.zeros(1))[0, :3, 3]
        ready = initial.copy()
        ready[2] = max(ready[2] + _LOWER_M, safe_height_m(self.scene))
        lattice, carryings = self._carried(turn.branch)
        straight = upright_azimuth_rad(task.theta_rad, turn.psi_rad)
        spins = (straight - lattice.azimuths_rad + np.pi) % (2 * np.pi) - np.pi
        lay_cost = np.abs(spins) + _METRE_COST_RAD * np.linalg.norm(lattice.positions_m - ready, axis=1)
        carry_cost = np.min([carrying.cost_rad for carrying in carryings], axis=0)
        cost = np.where(lay_cost < _LAY_COST_RAD, lay_cost + _CARRY_SHARE * carry_cost, np.inf)
        nearest = np.argsort(cost, kind="stable")[: _LAYS[1]]
        nearest = nearest[np.isfinite(cost[nearest])]
        if not len(nearest):
            reasons.add(4, "The arm cannot bring the upright cup anywhere near this pour.")
            return
        clear = np.zeros(0, dtype=bool)
        for some in (nearest[: _LAYS[0]], nearest[_LAYS[0] :]):
            if len(some) and not clear.any():
                ways = [
                    lay_grasps(self.pouring, task, turn, lattice.positions_m[k], spins[k], ready, _LAY)
                    for k in some
                ]
                clear, nearest = clear_ways(self.scene, turn.branch, np.array(ways)), some
        if not clear.any():
            reasons.add(5, f"The arm cannot lay the cup down for this pour{_CLEARLY}")
        for k in nearest[clear]:
            for carrying in carryings:
                carry = carrying.to(int(k)) if np.isfinite(carrying.cost_rad[k]) else None
                if carry is None:
                    reasons.add(6, f"The arm cannot carry the upright cup to this pour{_CLEARLY}")
                    continue
                place, spin = lattice.positions_m[k], float(spins[k])
                yield Way(task, turn, carrying.grip, carry, place, spin, ready, initial)

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
