"""Whether a reference view notices a camera that moved, and stays quiet when it did not.

Usage: python -m tests.benchmarks.drift [--cells N] [--seed S]
Random cells as in `tests.benchmarks.hand_eye`: one look is stored, then compared with looks by a camera that
did not move, moved by 3 mm, or turned by 0.5 degrees, in random directions. Corners are computed, and noisy
by 0.1 to 0.3 px in each image; the arm comes back to within what UR states.
"""

from __future__ import annotations

import argparse

import numpy as np

from core.calibration.detection import Detection
from core.calibration.drift import N_IMAGES, Drift, StillLook, measure_drift, still_look
from core.calibration.lens import project
from core.calibration.proposing import ProposalTask, propose_poses
from core.calibration.rig import Rig, exp_pose
from core.geometry import FloatArray, invert_pose, transform_points
from hardware.simulation.depth_camera import CARMINE_INTRINSICS, HEIGHT, WIDTH
from tests.benchmarks.hand_eye import BOARD, CELL, LENS, SCENE, Setup, random_setup

REPEATED_M, REPEATED_RAD = 0.0001, np.radians(0.01)
"""Standard deviation per axis of an arm that comes back to the same joints; a UR5 is stated to +-0.1 mm."""
DRIFT_M, DRIFT_RAD = 0.003, np.radians(0.5)
_MARGIN_PX = 25.0


def look(setup: Setup, T_base_flange: FloatArray, T_flange_camera: FloatArray) -> StillLook:
    """Look at the board from a pose of the arm, with a camera that hangs at (4, 4)."""
    noise = setup.random.normal(size=6) * ([REPEATED_RAD] * 3 + [REPEATED_M] * 3)
    T_camera_base = invert_pose(T_base_flange @ exp_pose(noise) @ T_flange_camera)
    exact = project(CARMINE_INTRINSICS, transform_points(T_camera_base @ setup.T_base_board, BOARD.corners_m))
    ids = np.arange(len(exact))
    images = [
        Detection(ids, exact + setup.random.normal(0, setup.corner_px, exact.shape), np.eye(4), 0.0)
        for _ in range(N_IMAGES)
    ]
    return still_look(images)


def drifts(seed: int) -> tuple[Drift, Drift, Drift]:
    """What is measured in one cell: of a camera that did not move, one that moved, one that turned."""
    setup = random_setup(seed)
    rig = Rig(setup.T_flange_camera, setup.T_base_board, CARMINE_INTRINSICS)
    home = np.array(CELL.robot.home_rad)
    [pose] = propose_poses(SCENE, ProposalTask(rig, BOARD, (WIDTH, HEIGHT), home, _MARGIN_PX), 1)
    before = look(setup, pose.T_base_flange, setup.T_flange_camera)
    direction = setup.random.normal(size=3)
    direction /= np.linalg.norm(direction)
    still, moved, turned = np.zeros(6), np.zeros(6), np.zeros(6)
    moved[3:], turned[:3] = DRIFT_M * direction, DRIFT_RAD * direction
    found = [
        measure_drift(
            before, look(setup, pose.T_base_flange, setup.T_flange_camera @ exp_pose(change)), BOARD, LENS
        )
        for change in (still, moved, turned)
    ]
    return found[0], found[1], found[2]


def is_noticed(drift: Drift) -> bool:
    """Whether a scan would warn or refuse, with the usual limits."""
    return drift.position_m > CELL.scan.drift_m or drift.angle_rad > CELL.scan.drift_rad


def main() -> None:
    """Run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    found = [drifts(given.seed + k) for k in range(given.cells)]
    names = (
        "did not move",
        f"moved by {1000 * DRIFT_M:.0f} mm",
        f"turned by {np.degrees(DRIFT_RAD):.1f} deg",
    )
    for name, one in zip(names, zip(*found, strict=True), strict=True):
        mm = 1000 * np.array([drift.position_m for drift in one])
        deg = np.degrees([drift.angle_rad for drift in one])
        print(
            f"{name:<18} noticed in {sum(map(is_noticed, one))} of {len(one)}; measured "
            f"{mm.min():.2f} to {mm.max():.2f} mm (median {np.median(mm):.2f}), "
            f"{deg.min():.2f} to {deg.max():.2f} deg (median {np.median(deg):.2f})"
        )


if __name__ == "__main__":
    main()
