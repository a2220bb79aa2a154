"""How far published kinematics put the tool beside where an arm has it, at the cup and where it pours.

500 arms are drawn whose axes lie beside the published ones, evenly by up to 1 mm and 1 mrad along each axis
of the base frame: an assumption, not a maker's figure. Run by `make own-kinematics`.
"""

from __future__ import annotations

import numpy as np

from core.motion.factory_calibration import calibrated
from core.motion.kinematics import flange_pose
from core.motion.pour.planning import plan_pour
from core.motion.pour.stand_in import judge_reach
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import RunHere
from hardware.cell import read_cell
from hardware.cell.scene import pour_cell
from tests.core.motion.measured_arms import measured_arm

N_ARMS = 500
OFF_M, OFF_RAD = 0.001, 0.001


def main() -> None:
    """Print how far off the tool is at the cup, when the pour begins, and when it ends."""
    settings = read_cell()
    cell = pour_cell(settings)
    reach = judge_reach(cell, settings.place.platform_center_m, PouringParameters(), RunHere(), Reporter())
    target = reach.target("")
    assert target is not None, "the shipped cell pours"
    moves = {move.name.value: move.trajectory for move in plan_pour(cell, target, cell.home_rad).moves}
    joints = np.array([moves["grasp"].end_rad, moves["pour"].start_rad, moves["pour"].end_rad])
    published = flange_pose(cell.arm, joints) @ cell.T_flange_grasp
    off_mm = np.empty((N_ARMS, 3))
    for seed in range(N_ARMS):
        own = calibrated(cell.arm, measured_arm(cell.arm, seed, OFF_M, OFF_RAD))
        tools = flange_pose(own, joints) @ cell.T_flange_grasp
        off_mm[seed] = 1000 * np.linalg.norm((tools - published)[:, :3, 3], axis=1)
    for name, column in zip(("at the cup", "pour begins", "pour ends"), off_mm.T, strict=True):
        print(
            f"{name}: median {np.median(column):.2f} mm, 95 % {np.percentile(column, 95):.2f} mm, worst "
            f"{column.max():.2f} mm"
        )


if __name__ == "__main__":
    main()
