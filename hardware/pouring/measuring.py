"""What the driven motion was like, by what the controller reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.geometry import FloatArray, make_pose
from core.imagination.cup import pivot_in_cup_m
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from core.parameters.imagination import CupParameters
from hardware.pouring.run_log import read_states

TURN = "pour"


def driven_pivot_error_m(
    folder: Path, arm: ArmModel, T_flange_cup: FloatArray, cup: CupParameters, pivot_m: FloatArray
) -> float:
    """How far the pivot was from where it should be, at worst, in the turn of a run.

    Args:
        folder: of the run.
        arm: whose kinematics.
        T_flange_cup: (4, 4) the cup in the hand.
        cup: its measures.
        pivot_m: (3,) r_pivot in the base frame.
    """
    joints_rad = read_states(folder, {TURN}).joints_rad
    T_flange_pivot = T_flange_cup @ make_pose(np.eye(3), pivot_in_cup_m(cup))
    pivots_m = (flange_pose(arm, joints_rad) @ T_flange_pivot)[:, :3, 3]
    return float(np.linalg.norm(pivots_m - pivot_m, axis=1).max(initial=0.0))
