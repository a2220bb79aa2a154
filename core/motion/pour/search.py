"""The search for a pour's motion: how the cup sits in the hand, where it is tilted, how it gets there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.kinematics import inverse_kinematics, singularity_measure
from core.motion.pour.carrying import (
    METRE_COST_RAD,
    Carry,
    Carrying,
    Lattice,
    clear_paths,
    find_lattice,
    safe_height_m,
    why_not,
)
from core.motion.pour.geometry import hand_angle_rad, pouring_grasps, tilting_grasps, upright_azimuth_rad
from core.motion.pour.plan import PourTarget, Segment
from core.motion.pour.scene import PourScene, too_close
from core.motion.pour.station import Grip

_N_PSI = 24
_STEP_RAD = 2 * np.pi / _N_PSI
_N_GAMMAS = 6
_TILT_SHARES = np.linspace(0, 1, 8)
"""Shares of the tilting path that are checked first."""
_CANDIDATES = 24, 120
"""Upright placements tried for tilting the cup: the first few, and this many if none of them will do."""
_LOWER_M = 0.03
"""The cup is tilted at least this far above where the pour starts."""
_TILT_COST_RAD = 8.0
"""Upright placements that are farther off than this are not tried."""
_CARRY_SHARE = 0.3
"""Weight of a longer path to a placement against a longer tilting path from it."""


class Stage(IntEnum):
    """How far an attempt came: the stage at which it failed."""

    START = 0
    REACH = 1
    SINGULARITY = 2
    HAND = 3
    CUP = 4
    PLACEMENT = 5
    TILT = 6
    CARRY = 7
    CHECK = 8


@dataclass
class Reasons:
    """Why there is no plan: the sentence of the attempt that came farthest.

    Attributes:
        stage: how far it came.
        sentence: why it came no farther.
    """

    stage: Stage = Stage.START
    sentence: str = ""

    def add(self, stage: Stage, sentence: str) -> None:
        """Keep a sentence if no other attempt came this far."""
        if stage > self.stage:
            self.stage, self.sentence = stage, sentence


@dataclass(frozen=True)
class PourGrasp:
    """One way to hold the cup in the pour.

    Attributes:
        psi_rad: how the cup sits in the hand.
        branch: of the inverse kinematics.
    """

    psi_rad: float
    branch: int


@dataclass(frozen=True)
class PourPath:
    """Everything that defines a pour's motion except its times.

    Attributes:
        target: the pour.
        grasp: how the cup is held.
        grip: how it is taken.
        carry: stretches to where it is tilted.
        upright_m: (3,) the tool frame's origin there.
        spin_rad: rotation of the hand about the cup's axis during tilting.
        ready_m: (3,) the tool frame's origin above the start of the pour.
        initial_m: (3,) and at its start.
    """

    target: PourTarget
    grasp: PourGrasp
    grip: Grip
    carry: Carry
    upright_m: FloatArray
    spin_rad: float
    ready_m: FloatArray
    initial_m: FloatArray


class PathSearch:
    """Finds paths for the pours onto one object; what several pours need is computed once."""

    def __init__(self, scene: PourScene, grips: Sequence[Grip]) -> None:
        """Search with these ways to take the cup."""
        self.scene = scene
        self._grips = grips
        self._branches = sorted({grip.branch for grip in grips})
        self._carried: dict[int, tuple[Lattice, list[Carrying]]] = {}

    def paths(self, target: PourTarget, reasons: Reasons) -> Iterator[PourPath]:
        """Yield paths that are clear at some points along them, the best first."""
        for grasp in _find_grasps(self.scene, target, self._branches, reasons):
            yield from self._paths_to(target, grasp, reasons)

    def _paths_to(self, target: PourTarget, grasp: PourGrasp, reasons: Reasons) -> Iterator[PourPath]:
        grip_height = self.scene.cell.grip_height_m
        initial = pouring_grasps(target, grip_height, grasp.psi_rad, np.zeros(1))[0, :3, 3]
        ready = initial.copy()
        ready[2] = max(ready[2] + _LOWER_M, safe_height_m(self.scene))
        lattice, carryings = self._carried_on(grasp.branch)
        spins = upright_azimuth_rad(target.theta_rad, grasp.psi_rad) - lattice.azimuths_rad
        spins = (spins + np.pi) % (2 * np.pi) - np.pi
        for k in self._placements(target, grasp, spins, ready, reasons):
            for carrying in carryings:
                carry = carrying.to(k) if np.isfinite(carrying.cost_rad[k]) else None
                if carry is None:
                    reasons.add(
                        Stage.CARRY, "No clear path was found on which to carry the upright cup to this pour."
                    )
                    continue
                upright, spin = lattice.positions_m[k], float(spins[k])
                yield PourPath(target, grasp, carrying.grip, carry, upright, spin, ready, initial)

    def _placements(
        self,
        target: PourTarget,
        grasp: PourGrasp,
        spins_rad: FloatArray,
        ready_m: FloatArray,
        reasons: Reasons,
    ) -> Iterator[int]:
        """Upright placements from which the cup can be tilted above a pour: of the first batch with any."""
        lattice, carryings = self._carried_on(grasp.branch)
        positions = lattice.positions_m
        cost = np.abs(spins_rad) + METRE_COST_RAD * np.linalg.norm(positions - ready_m, axis=1)
        too_far = cost > _TILT_COST_RAD
        cost += _CARRY_SHARE * np.min([carrying.cost_rad for carrying in carryings], axis=0)
        cost[too_far] = np.inf
        nearest: IntArray = np.argsort(cost, kind="stable")[: _CANDIDATES[1]]
        nearest = nearest[np.isfinite(cost[nearest])]
        if not len(nearest):
            reasons.add(
                Stage.PLACEMENT, "No clear path was found that brings the upright cup near this pour."
            )
            return
        for batch in (nearest[: _CANDIDATES[0]], nearest[_CANDIDATES[0] :]):
            paths = [
                tilting_grasps(target, grasp.psi_rad, positions[k], spins_rad[k], ready_m, _TILT_SHARES)
                for k in batch
            ]
            clear = clear_paths(
                self.scene, grasp.branch, np.array(paths).reshape(-1, len(_TILT_SHARES), 4, 4)
            )
            if clear.any():
                yield from batch[clear].tolist()
                return
            if reasons.stage < Stage.TILT:
                reasons.add(Stage.TILT, why_not(self.scene, grasp.branch, paths[0], Segment.TILT))

    def _carried_on(self, branch: int) -> tuple[Lattice, list[Carrying]]:
        """Where a branch may hold the cup upright, and the paths there from each of its grips."""
        if branch not in self._carried:
            lattice = find_lattice(self.scene, branch)
            own = [grip for grip in self._grips if grip.branch == branch]
            self._carried[branch] = lattice, [Carrying(self.scene, grip, lattice) for grip in own]
        return self._carried[branch]


def _find_grasps(
    scene: PourScene, target: PourTarget, branches: Sequence[int], reasons: Reasons
) -> list[PourGrasp]:
    """Return how the cup may be held, checked at a few angles of the pour rotation.

    The hand opposite to the pivot, above the tilted cup, comes first; then more and more to the side.
    """
    gammas = np.linspace(0, target.pouring.gamma_0_rad, _N_GAMMAS)
    offsets = _STEP_RAD * np.array([(k + 1) // 2 * (1 if k % 2 else -1) for k in range(_N_PSI)])
    psis = hand_angle_rad(scene.cell.T_flange_grasp) + offsets
    height = scene.cell.grip_height_m
    poses = np.concatenate([pouring_grasps(target, height, float(psi), gammas) for psi in psis])
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(poses), branches)
    shape = _N_PSI, _N_GAMMAS, len(branches)
    reached = (result.found & ~result.undetermined).reshape(shape).all(axis=1)
    if not reached.any():
        reasons.add(Stage.REACH, "The arm cannot reach this pour, whichever side of the cup its hand is on.")
        return []
    joints = result.joints_rad.reshape(*shape, 6).transpose(0, 2, 1, 3)[reached]
    clear = _are_clear(scene, joints, reasons)
    return [PourGrasp(float(psis[k]), branches[b]) for k, b in np.argwhere(reached)[clear]]


def _are_clear(scene: PourScene, joints: FloatArray, reasons: Reasons) -> BoolArray:
    """Which pour rotations (C, K, 6) are clear and not singular."""
    limits, shape = scene.cell.limits, joints.shape[:2]
    regular: BoolArray = singularity_measure(scene.cell.arm, joints).min(axis=1) >= limits.min_singularity
    if not regular.any():
        sentence = "In the move 'pour' the arm would come too close to a singular configuration."
        reasons.add(Stage.SINGULARITY, sentence)
        return regular
    hand = scene.hand.clearance(joints.reshape(-1, 6))
    distances = np.where(regular[:, None], hand.distance_m.reshape(shape), -np.inf)
    clear: BoolArray = distances.min(axis=1) >= limits.min_clearance_m
    if not clear.any():
        worst = _worst_of_best(distances)
        distance = float(hand.distance_m[worst])
        reasons.add(
            Stage.HAND, too_close(Segment.POUR, hand.nearest(worst), distance, limits.min_clearance_m)
        )
        return clear
    held = joints[clear].reshape(-1, 6)
    cup = scene.cup_clearance(scene.held_cups(held), held)
    distances = cup.distance_m.reshape(-1, shape[1])
    clear[clear] = distances.min(axis=1) >= limits.cup_clearance_m
    if not clear.any():
        worst = _worst_of_best(distances)
        distance = float(cup.distance_m[worst])
        reasons.add(Stage.CUP, too_close(Segment.POUR, cup.nearest(worst), distance, limits.cup_clearance_m))
    return clear


def _worst_of_best(distances_m: FloatArray) -> int:
    """Flat index of the smallest distance in the row of (C, K) whose smallest is largest."""
    best = int(distances_m.min(axis=1).argmax())
    return int(best * distances_m.shape[1] + distances_m[best].argmin())
