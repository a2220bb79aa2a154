"""Hand-eye calibration in random simulated cells: errors, stated bounds, and OpenCV's methods beside it.

Usage: python -m tests.benchmarks.hand_eye [--cells N] [--views N] [--seed S]
Corners are computed, not rendered: their noise is the one that is asked for. Everything else is the program's
own: the first guess is wrong by up to 20 mm and 10 degrees, poses are proposed round by round, views that
show too little of the board are refused and replaced.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import cv2
import numpy as np

from core.calibration.accuracy import Bounds, bounds, place_errors
from core.calibration.board import BoardSpec
from core.calibration.collecting import Collection, Look
from core.calibration.detection import pose_of_corners
from core.calibration.hand_eye import calibrate_hand_eye
from core.calibration.lens import Lens, project
from core.calibration.rig import exp_pose, log_pose
from core.calibration.view_set import why_too_little, why_wrong
from core.calibration.views import FEWEST_SHARE, BoardView
from core.errors import StageError
from core.geometry import (
    FloatArray,
    invert_pose,
    look_at,
    make_pose,
    rotation_x,
    rotation_z,
    transform_points,
)
from core.motion.kinematics import flange_pose
from hardware.cell import read_cell
from hardware.cell.scene import board_scene
from hardware.simulation.depth_camera import CARMINE_INTRINSICS, HEIGHT, WIDTH

ARM_POSITION_M, ARM_ANGLE_RAD = 0.0003, np.radians(0.03)
"""Standard deviations per axis."""
CORNER_PX = (0.1, 0.3)
GUESS_M, GUESS_RAD = 0.020, np.radians(10.0)
BY_HAND_M = np.array([0.15, 0.1, 0.45])
"""From the board to where a person guides the camera."""
POOR_VIEWS, POOR_RAD = 6, np.radians(10.0)
METHODS = {
    "Tsai": cv2.CALIB_HAND_EYE_TSAI,
    "Park": cv2.CALIB_HAND_EYE_PARK,
    "Horaud": cv2.CALIB_HAND_EYE_HORAUD,
    "Andreff": cv2.CALIB_HAND_EYE_ANDREFF,
    "Daniilidis": cv2.CALIB_HAND_EYE_DANIILIDIS,
}
CELL = read_cell()
SCENE = board_scene(CELL)
BOARD = BoardSpec()
LENS = Lens(CARMINE_INTRINSICS)
PLACE_M = CELL.place.platform_center_m
SCAN_FLANGES = flange_pose(SCENE.arm, np.array(CELL.scan.views_rad))


@dataclass(frozen=True)
class Setup:
    """One random cell: the truth, and its noise."""

    T_flange_camera: FloatArray
    T_base_board: FloatArray
    corner_px: float
    random: np.random.Generator

    def look(self, name: str, T_base_flange: FloatArray) -> BoardView | None:
        """See the board from where the arm believes to be; none if too few corners are in the image."""
        noise = self.random.normal(size=6) * ([ARM_ANGLE_RAD] * 3 + [ARM_POSITION_M] * 3)
        T_camera_base = invert_pose(T_base_flange @ exp_pose(noise) @ self.T_flange_camera)
        points = transform_points(T_camera_base @ self.T_base_board, BOARD.corners_m)
        seen = project(CARMINE_INTRINSICS, points) + self.random.normal(0, self.corner_px, (len(points), 2))
        inside = ((seen > 5) & (seen < [WIDTH - 6, HEIGHT - 6])).all(axis=1) & (points[:, 2] > 0.1)
        if inside.sum() < 8:
            return None
        ids = np.flatnonzero(inside)
        pose, _ = pose_of_corners(BOARD, LENS, ids, seen[ids])
        return BoardView(name, T_base_flange, ids, seen[ids], pose)


@dataclass(frozen=True)
class Errors:
    """Of a hand-eye pose: metres, radians, and metres at the place of pouring."""

    position_m: float
    angle_rad: float
    pouring_m: float


def random_setup(seed: int) -> Setup:
    """Draw a cell whose camera hangs elsewhere than the file says, and a board near the platform."""
    random = np.random.default_rng(seed)
    turn, shift = random.normal(size=3), random.normal(size=3)
    turn *= GUESS_RAD * random.uniform() ** (1 / 3) / np.linalg.norm(turn)
    shift *= GUESS_M * random.uniform() ** (1 / 3) / np.linalg.norm(shift)
    middle = PLACE_M + np.array([*random.uniform(-0.05, 0.05, 2), 0.003])
    lying = make_pose(rotation_z(random.uniform(0, 2 * np.pi)) @ rotation_x(np.pi), middle)
    T_base_board = lying @ make_pose(np.eye(3), -BOARD.center_m)
    T_flange_camera = CELL.camera.pose @ exp_pose(np.concatenate([turn, shift]))
    return Setup(T_flange_camera, T_base_board, random.uniform(*CORNER_PX), random)


def collect(setup: Setup, n_views: int) -> tuple[BoardView, ...]:
    """Take views as the program does, beginning with one for which the arm was guided by hand."""
    home = np.array(CELL.robot.home_rad)
    collection = Collection(
        SCENE, BOARD, CARMINE_INTRINSICS, (WIDTH, HEIGHT), CELL.camera.pose, home, n_wanted=n_views
    )
    middle = transform_points(setup.T_base_board, BOARD.center_m)
    by_hand = look_at(middle + BY_HAND_M, middle) @ invert_pose(setup.T_flange_camera)
    collection.looks.append(Look(np.full(6, 9.0), setup.look("by hand", by_hand)))
    n_round = 0
    while poses := collection.next_poses(home, n_round):
        for pose in poses:
            view = setup.look(f"view {len(collection.looks)}", pose.T_base_flange)
            is_whole = view is not None and len(view.ids) >= FEWEST_SHARE * BOARD.n_corners
            collection.looks.append(Look(pose.joints_rad, view, "" if is_whole else "cut off"))
        n_round += 1
    return collection.views


def poor_views(setup: Setup) -> tuple[BoardView, ...]:
    """Six views turned by at most 10 degrees about each axis."""
    middle = transform_points(setup.T_base_board, BOARD.center_m)
    first = look_at(middle + BY_HAND_M, middle)
    views = []
    for k in range(POOR_VIEWS):
        turn = exp_pose(np.array([*setup.random.uniform(-POOR_RAD, POOR_RAD, 3), 0, 0, 0]))
        camera = make_pose(np.eye(3), middle) @ turn @ make_pose(np.eye(3), -middle) @ first
        view = setup.look(f"view {k}", camera @ invert_pose(setup.T_flange_camera))
        assert view is not None
        views.append(view)
    return tuple(views)


def errors(found: FloatArray, truth: FloatArray) -> Errors:
    """Compare hand-eye poses (4, 4)."""
    change = log_pose(invert_pose(found) @ truth)
    at_place = place_errors(found, change[None], SCAN_FLANGES, PLACE_M)
    pouring_m = float(np.sqrt((at_place**2).mean()))
    return Errors(float(np.linalg.norm(change[3:])), float(np.linalg.norm(change[:3])), pouring_m)


def opencv(views: tuple[BoardView, ...], method: int) -> FloatArray:
    """One of OpenCV's closed forms; NaN if it does not answer."""
    flange, board = [v.T_base_flange for v in views], [v.T_camera_board for v in views]
    try:
        turn, shift = cv2.calibrateHandEye(
            [T[:3, :3] for T in flange], [T[:3, 3] for T in flange],
            [T[:3, :3] for T in board], [T[:3, 3] for T in board], method=method,
        )  # fmt: skip
    except cv2.error:
        return np.full((4, 4), np.nan)
    return make_pose(turn, np.ravel(shift))


def table(name: str, found: list[Errors]) -> str:
    """Median and worst of a method."""
    mm = np.array([e.position_m for e in found]) * 1000
    deg = np.degrees([e.angle_rad for e in found])
    at = np.array([e.pouring_m for e in found]) * 1000
    return (
        f"{name:<22}{np.median(mm):8.2f}{np.max(mm):8.2f}{np.median(deg):10.3f}{np.max(deg):8.3f}"
        f"{np.median(at):10.2f}{np.max(at):8.2f}"
    )


def within(found: list[Errors], stated: list[Bounds]) -> str:
    """How often the truth lies within what was stated."""
    shares = [
        np.mean([getattr(e, name) <= getattr(b, name) for e, b in zip(found, stated, strict=True)])
        for name in ("position_m", "angle_rad", "pouring_m")
    ]
    return "position {:.1%}, angle {:.1%}, at the place of pouring {:.1%}".format(*shares)


def good_sets(n_cells: int, n_views: int, seed: int) -> None:
    """Print the table of the fit and of OpenCV's methods on the same views."""
    ours: list[Errors] = []
    stated: list[Bounds] = []
    others: dict[str, list[Errors]] = {name: [] for name in METHODS}
    refused, seconds = [], []
    for k in range(n_cells):
        setup = random_setup(seed + k)
        views = collect(setup, n_views)
        start = time.perf_counter()
        fit = calibrate_hand_eye(views, BOARD, CARMINE_INTRINSICS)
        stated.append(bounds(fit, SCAN_FLANGES, PLACE_M))
        seconds.append(time.perf_counter() - start)
        problem = why_too_little(views, fit.T_flange_camera) or why_wrong(fit, views, BOARD)
        refused += [problem] if problem or len(views) < n_views else []
        ours.append(errors(fit.T_flange_camera, setup.T_flange_camera))
        for name, method in METHODS.items():
            others[name].append(errors(opencv(views, method), setup.T_flange_camera))
    print(f"{n_cells} cells, {n_views} proposed views each, {len(refused)} of the sets refused {refused[:1]}")
    print(f"{'':<22}{'mm':>8}{'worst':>8}{'degrees':>10}{'worst':>8}{'pour mm':>10}{'worst':>8}")
    print(table("joint adjustment", ours))
    for name, found in others.items():
        print(table(f"OpenCV {name}", found))
    middle = [np.median([getattr(b, n) for b in stated]) for n in ("position_m", "angle_rad", "pouring_m")]
    print(
        f"stated with 95 % (median): {middle[0] * 1000:.2f} mm, {np.degrees(middle[1]):.3f} degrees, "
        f"{middle[2] * 1000:.2f} mm at the place of pouring"
    )
    print(f"truth within what is stated: {within(ours, stated)}")
    print(f"a fit with its bounds takes {np.median(seconds):.2f} s")


def poor_sets(n_cells: int, seed: int) -> None:
    """Print what becomes of six views that are too similar."""
    refused, found, stated, park = 0, [], [], []
    for k in range(n_cells):
        setup = random_setup(seed + k)
        views = poor_views(setup)
        refused += why_too_little(views, CELL.camera.pose) is not None
        park.append(errors(opencv(views, METHODS["Park"]), setup.T_flange_camera))
        try:
            fit = calibrate_hand_eye(views, BOARD, CARMINE_INTRINSICS)
        except StageError:
            continue
        found.append(errors(fit.T_flange_camera, setup.T_flange_camera))
        stated.append(bounds(fit, SCAN_FLANGES, PLACE_M))
    print(f"\n{POOR_VIEWS} views within 10 degrees: {refused} of {n_cells} refused; fitted all the same:")
    print(table("joint adjustment", found))
    print(table("OpenCV Park", park))
    print(f"truth within what is stated: {within(found, stated)}")


def main() -> None:
    """Run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=50)
    parser.add_argument("--views", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    good_sets(given.cells, given.views, given.seed)
    poor_sets(given.cells, given.seed)


if __name__ == "__main__":
    main()
