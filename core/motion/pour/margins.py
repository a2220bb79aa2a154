"""What each move of a plan leaves for errors, by its own clearances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.margin import SHARE_OF_CLEARANCE, PathMargin, path_margin
from core.motion.pour.cell import PourCell
from core.motion.pour.plan import PlannedMove, PourPlan, PourTarget, Segment, is_reversed
from core.motion.pour.scene import PourScene, check_clearance


@dataclass(frozen=True)
class MoveMargin:
    """Of one move.

    Attributes:
        path: how far beside its path the arm may be.
        kinematics_m: how far what is in the hand may be from where the arm model's kinematics put it.
        held_m: (P, 3) points of the cup and of the hand at it, in the tool's frame.
    """

    path: PathMargin
    kinematics_m: float
    held_m: FloatArray

    def misplaced_m(self, T_base_tool: FloatArray, T_reported: FloatArray) -> float:
        """Return how far any held point is from its place, by two poses (4, 4) of the tool."""
        change = T_reported - T_base_tool
        return float(np.linalg.norm(self.held_m @ change[:3, :3].T + change[:3, 3], axis=1).max())


def plan_margins(cell: PourCell, target: PourTarget, plan: PourPlan) -> dict[Segment, MoveMargin]:
    """Return the margin of each move of a plan that passes its checks.

    Raises:
        MotionError: it does not.
    """
    scene = PourScene(cell, target.object_aabb_m, target.pouring.cup)
    margins = {move.name: _margin(scene, move) for move in plan.moves if not is_reversed(move)}
    names = [move.name for move in plan.moves]
    return {name: margins.get(name) or margins[names[-1 - k]] for k, name in enumerate(names)}


def _margin(scene: PourScene, move: PlannedMove) -> MoveMargin:
    least = check_clearance(scene, [move])
    clearance_m = min(least.clearance_m, least.cup_clearance_m)
    in_tool_m = scene.hand_points(np.eye(4)[None])[0]
    in_flange_m = scene.hand_points(scene.cell.T_flange_grasp[None])[0]
    path = path_margin(scene.hand, move.trajectory.joints_rad, clearance_m, in_flange_m)
    return MoveMargin(path, (1 - SHARE_OF_CLEARANCE) * clearance_m, in_tool_m)


def refuse_misplaced(margin: MoveMargin, T_base_tool: FloatArray, T_reported: FloatArray) -> None:
    """Refuse an arm whose kinematics differ by more from the model's than a move's clearance allows.

    Args:
        margin: of the move.
        T_base_tool: (4, 4) the tool by the model's kinematics.
        T_reported: (4, 4) the same as the controller reports it.

    Raises:
        MotionError: they do.
    """
    off_m = margin.misplaced_m(T_base_tool, T_reported)
    if off_m > margin.kinematics_m:
        raise MotionError(
            f"The controller has the cup {off_m * 1000:.1f} mm from where the cell's arm model puts it, and "
            f"the plan's clearance leaves {margin.kinematics_m * 1000:.1f} mm for that; connect the "
            "arm again, so that its own calibration is read from its controller, or choose a larger "
            "cup_clearance_m in the cell file."
        )
