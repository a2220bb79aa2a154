"""The shipped cell's scan views: different from each other, reachable, clear, and looking at the object."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np

from core.geometry import FloatArray, invert_pose, transform_points
from core.motion.joint_path import RouteSettings, check_path, find_route
from core.motion.kinematics import flange_pose, within_limits
from hardware.cell import read_cell
from hardware.cell.scene import motion_scene
from hardware.cell.settings import ARMS
from hardware.simulation.depth_camera import CARMINE_INTRINSICS, HEIGHT, WIDTH

CELL = read_cell()
ARM = ARMS[CELL.robot.model]
VIEWS = np.array(CELL.scan.views_rad)
CLEARANCE_M = 0.02


def camera_poses() -> FloatArray:
    poses: FloatArray = flange_pose(ARM, VIEWS) @ CELL.camera.pose
    return poses


def test_24_views_within_the_limits_and_none_twice() -> None:
    assert VIEWS.shape == (24, 6)
    assert within_limits(ARM, VIEWS).all()
    for one, other in combinations(camera_poses(), 2):
        turn = one[:3, :3].T @ other[:3, :3]
        apart_deg = np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
        apart_m = np.linalg.norm(one[:3, 3] - other[:3, 3])
        assert apart_m > 0.03 or apart_deg > 5


def test_home_and_all_views_are_clear_of_everything() -> None:
    clearance = motion_scene(CELL).clearance(np.vstack([CELL.robot.home_rad, VIEWS]))
    assert clearance.distance_m.min() >= CLEARANCE_M


def test_there_is_a_clear_way_from_home_through_all_views() -> None:
    scene = motion_scene(CELL)
    options = RouteSettings(min_clearance_m=CLEARANCE_M, via_rad=(CELL.robot.home_rad,))
    for start, goal in pairwise(np.vstack([CELL.robot.home_rad, VIEWS])):
        route = find_route(scene, start, goal, options)
        np.testing.assert_array_equal(route[[0, -1]], [start, goal])
        assert check_path(scene, route, CLEARANCE_M).is_clear


def test_every_view_looks_at_the_objects_box() -> None:
    low, high = np.array(CELL.place.crop_min_m), np.array(CELL.place.crop_max_m)
    axes = [np.linspace(a, b, 9) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    inner = (np.abs(points - (low + high) / 2) <= (high - low) / 4 + 1e-9).all(axis=1)
    k = CARMINE_INTRINSICS
    for pose in camera_poses():
        x, y, z = transform_points(invert_pose(pose), points).T
        assert z.min() > 0
        u, v = k.fx * x / z + k.cx, k.fy * y / z + k.cy
        seen = (u >= 0) & (u < WIDTH) & (v >= 0) & (v < HEIGHT)
        assert seen.mean() > 0.65
        assert seen[inner].mean() > 0.95


def test_the_middle_of_the_box_is_beyond_the_cameras_minimum_range() -> None:
    middle = (np.array(CELL.place.crop_min_m) + np.array(CELL.place.crop_max_m)) / 2
    distances = np.linalg.norm(camera_poses()[:, :3, 3] - middle, axis=1)
    assert distances.min() > CELL.camera.min_range_m + 0.05


def test_the_views_come_from_all_sides_and_from_low_to_steep() -> None:
    middle = (np.array(CELL.place.crop_min_m) + np.array(CELL.place.crop_max_m)) / 2
    towards = camera_poses()[:, :3, 3] - middle
    elevation_deg = np.degrees(np.arcsin(towards[:, 2] / np.linalg.norm(towards, axis=1)))
    assert elevation_deg.min() < 35
    assert elevation_deg.max() > 75
    azimuths_deg = np.sort(np.degrees(np.arctan2(towards[:, 1], towards[:, 0])))
    gaps_deg = np.diff([*azimuths_deg, azimuths_deg[0] + 360])
    assert gaps_deg.max() < 90


def test_the_scene_holds_table_platform_object_and_further_obstacles() -> None:
    monitor = {"name": "monitor", "min_m": (0.5, 0.4, 0.0), "max_m": (0.8, 0.5, 0.5)}
    cell = type(CELL).model_validate(CELL.model_dump() | {"obstacles": (monitor,)})
    names = [obstacle.name for obstacle in motion_scene(cell).obstacles]
    assert names == ["table", "platform", "object's box", "monitor"]
    assert {"gripper", "camera"} <= {capsule.name for capsule in motion_scene(cell).shape.capsules}


def test_one_way_straight_ahead_is_blocked_so_routes_matter() -> None:
    problem = check_path(motion_scene(CELL), VIEWS[[17, 18]], CLEARANCE_M).problem
    assert problem is not None
    assert problem.distance_m < CLEARANCE_M
