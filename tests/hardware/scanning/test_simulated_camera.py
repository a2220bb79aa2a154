"""What the simulated camera sees depends on where the simulated arm is, and on the seed."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry import FloatArray, invert_pose, transform_points
from core.scan.model import RgbdFrame
from hardware.cell import open_cell, read_cell
from hardware.cell.settings import CellSettings
from hardware.interfaces import CameraImage
from hardware.scanning.simulated import simulated_cell
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import place_on_platform
from hardware.simulation.world import World
from tests.hardware.scanning.faulty import SEED

PLACE = read_cell().place
VIEWS = read_cell().scan.views_rad


def shots(
    world: World, views: list[int], settings: CellSettings | None = None, seed: int = SEED
) -> tuple[list[CameraImage], list[FloatArray]]:
    """Images from a new cell's views, one after the other, and the camera's poses by the joints."""
    settings = settings or simulated_cell()
    images, poses = [], []
    with open_cell(settings, world, seed) as cell:
        for view in views:
            state = cell.robot.state()
            cell.robot.move_joints([state.joints_rad, VIEWS[view]], 1.0, 1.0).wait(1.0)
            images.append(cell.camera.capture())
            poses.append(cell.robot.state().T_base_flange @ settings.camera.pose)
    return images, poses


def points_m(image: CameraImage, pose: FloatArray) -> FloatArray:
    frame = RgbdFrame("frame-000000", image.color, image.depth_m, pose)
    return frame.points_m(image.intrinsics, max_depth_m=3.0, stride=3)


def test_another_place_another_image_and_what_it_shows_lies_where_it_is(world: World) -> None:
    (first, second), poses = shots(world, [0, 8])
    assert (first.color != second.color).any(axis=-1).mean() > 0.3
    assert second.time_s > first.time_s
    for image, pose in zip((first, second), poses, strict=True):
        below = points_m(image, pose)[:, 2]
        assert np.median(below) == pytest.approx(PLACE.table_height_m, abs=0.01)


def test_the_same_seed_and_joints_give_the_same_image_on_whatever_way(world: World) -> None:
    (image,), _ = shots(world, [8])
    (_, _, again), _ = shots(world, [0, 12, 8])
    np.testing.assert_array_equal(image.depth_m, again.depth_m)
    np.testing.assert_array_equal(image.color, again.color)


def test_two_shots_at_one_place_differ_by_noise_only(world: World) -> None:
    (one, two), _ = shots(world, [8, 8])
    assert not np.array_equal(one.depth_m, two.depth_m)
    # The error of the pose belongs to the joints, so nothing has moved.
    np.testing.assert_array_equal(one.color, two.color)
    both = (one.depth_m > 0) & (two.depth_m > 0)
    assert np.median(np.abs(one.depth_m - two.depth_m)[both]) < 0.004


def test_another_seed_is_another_error_of_the_pose(world: World) -> None:
    (one,), _ = shots(world, [8])
    (two,), _ = shots(world, [8], seed=SEED + 1)
    assert not np.array_equal(one.color, two.color)


def test_the_error_of_the_pose_is_of_the_size_that_is_set(world: World) -> None:
    noise = simulated_cell().simulation.noise
    still = noise.model_copy(update={"pose_position_m": 0.0, "pose_angle_rad": 0.0})
    (free,), _ = shots(world, [8], simulated_cell(still))
    (exact,), _ = shots(world, [8], simulated_cell(is_perfect=True))
    np.testing.assert_array_equal(free.color, exact.color)
    (moved,), _ = shots(world, [8])
    assert not np.array_equal(moved.color, exact.color)


def test_a_perfect_camera_is_exact(world: World) -> None:
    images, poses = shots(world, [0, 8, 8], simulated_cell(is_perfect=True))
    np.testing.assert_array_equal(images[1].depth_m, images[2].depth_m)
    mesh = builtin_object("mug")
    T_object_base = invert_pose(place_on_platform(mesh, SEED, PLACE))
    for image, pose in zip(images, poses, strict=True):
        points = points_m(image, pose)
        heights = points[:, 2] - PLACE.table_height_m
        on_table = heights < 0.03
        assert np.abs(heights[on_table]).max() < 1e-5
        above = transform_points(T_object_base, points[~on_table])
        assert len(above) > 300
        assert (above > mesh.aabb_min_m - 1e-5).all()
        assert (above < mesh.aabb_max_m + 1e-5).all()


def test_the_platform_is_not_seen(world: World) -> None:
    """Nothing lies at its height but the object, and the table shows through it."""
    (image,), (pose,) = shots(world, [8], simulated_cell(is_perfect=True))
    points = points_m(image, pose)
    low, high = np.array(PLACE.platform_min_m), np.array(PLACE.platform_max_m)
    over = (points[:, :2] > low).all(axis=1) & (points[:, :2] < high).all(axis=1)
    at_table = np.abs(points[:, 2] - PLACE.table_height_m) < 1e-4
    assert (over & at_table).sum() > 2000
    assert (at_table | (points[:, 2] > PLACE.platform_height_m - 1e-4)).all()
