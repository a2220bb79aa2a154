"""How the cup may be held in a pour so that the arm can turn it, and why it may not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.motion.inverse_kinematics import inverse_kinematics
from core.motion.kinematics import singularity_measure
from core.motion.pour.geometry import hand_angle_rad, laying_grasps, turned_cups
from core.motion.pour.scene import PourScene, too_near
from core.parameters.imagination import CupParameters, PouringParameters

_N_PSI = 24
_STEP_RAD = 2 * np.pi / _N_PSI
_N_PLACES = 6


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


REACH, BEND, HAND, RIM, NOWHERE, LAY, CARRY, FINE = range(8)
"""Stages in their order: what the last attempt failed at."""


def turn_grasps(
    scene: PourScene, cup: CupParameters, task: PourTask, psi_rad: float, gamma_rad: FloatArray
) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) that hold the cup at pour angles (N,), the pivot where it shall be."""
    cups = turned_cups(cup, task.pivot_m, task.theta_rad, gamma_rad)
    positions = cups[:, :3, 3] + scene.cell.grip_height_m * cups[:, :3, 2]
    return laying_grasps(cup, task.theta_rad, gamma_rad, np.full(len(gamma_rad), psi_rad), positions)


def find_turns(
    scene: PourScene,
    pouring: PouringParameters,
    task: PourTask,
    branches: Sequence[int],
    reasons: Reasons,
) -> list[Turn]:
    """Return how the cup may be held, looked at in a few places of the turn.

    The hand opposite to the pivot, above the lying cup, comes first; then the hand more and more aside.
    """
    gammas = np.linspace(0, pouring.gamma_0_rad, _N_PLACES)
    offsets = _STEP_RAD * np.array([(k + 1) // 2 * (1 if k % 2 else -1) for k in range(_N_PSI)])
    psis = hand_angle_rad(scene.cell.T_flange_grasp) + offsets
    poses = np.concatenate([turn_grasps(scene, pouring.cup, task, float(psi), gammas) for psi in psis])
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(poses), branches)
    shape = _N_PSI, _N_PLACES, len(branches)
    reached = (result.found & ~result.undetermined).reshape(shape).all(axis=1)
    if not reached.any():
        reasons.add(REACH, "The arm cannot reach this pour, on whichever side of the cup its hand is.")
        return []
    joints = result.joints_rad.reshape(*shape, 6).transpose(0, 2, 1, 3)[reached]
    fine = _are_clear(scene, joints, reasons)
    return [Turn(float(psis[k]), branches[b]) for k, b in np.argwhere(reached)[fine]]


def _are_clear(scene: PourScene, joints: FloatArray, reasons: Reasons) -> BoolArray:
    """Which turns (C, K, 6) are clear and not singular."""
    limits, shape = scene.cell.limits, joints.shape[:2]
    bent: BoolArray = singularity_measure(scene.cell.arm, joints).min(axis=1) >= limits.min_singularity
    if not bent.any():
        reasons.add(BEND, "In the move 'pour' the arm would come too near to a singular configuration.")
        return bent
    flat = joints.reshape(-1, 6)
    room = scene.hand.clearance(flat)
    hand = np.where(bent[:, None], room.distance_m.reshape(shape), -np.inf)
    fine: BoolArray = hand.min(axis=1) >= limits.min_clearance_m
    if not fine.any():
        worst = _worst_of_best(hand)
        distance = float(room.distance_m[worst])
        reasons.add(HAND, too_near("pour", room.nearest(worst), distance, limits.min_clearance_m))
        return fine
    held = joints[fine].reshape(-1, 6)
    cup = scene.cup_clearance(scene.held_cups(held), held)
    around = cup.distance_m.reshape(-1, shape[1])
    fine[fine] = around.min(axis=1) >= limits.cup_clearance_m
    if not fine.any():
        worst = _worst_of_best(around)
        distance = float(cup.distance_m[worst])
        reasons.add(RIM, too_near("pour", cup.nearest(worst), distance, limits.cup_clearance_m))
    return fine


def _worst_of_best(distances_m: FloatArray) -> int:
    """Flat index of the smallest distance in the row of (C, K) whose smallest is largest."""
    best = int(distances_m.min(axis=1).argmax())
    return int(best * distances_m.shape[1] + distances_m[best].argmin())
