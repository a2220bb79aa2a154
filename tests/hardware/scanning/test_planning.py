"""From where an object is scanned: what a first look decides, and whole scans of large objects."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.mesh import SurfaceDistance, TriangleMesh
from core.motion.joint_path import check_path
from core.parameters import Parameters
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from hardware.cell import open_cell, read_cell
from hardware.cell.scene import motion_scene, object_space
from hardware.scanning.first_look import first_look_views
from hardware.scanning.planning import cell_for_plan, plan_scan
from hardware.scanning.simulated import simulate_scan, simulated_cell
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import place_on_platform, transform_mesh, world_with
from hardware.simulation.world import World
from tests.hardware.scanning.faulty import WatchedRobot
from tests.large_objects import INSIDE_M, SEEN_M, cylinder, floor_heights_m, open_box

CELL = read_cell()
SPACE = object_space(CELL)
SEED = 0
UNSEEN_M = 0.02
"""How far a side may be off that no view sees: what hides behind a wall counts as solid."""


def placed(mesh: TriangleMesh) -> TriangleMesh:
    return transform_mesh(mesh, place_on_platform(mesh, SEED, CELL.place, SPACE))


def opened(mesh: TriangleMesh, settings=CELL):
    return open_cell(settings, world_with(mesh, settings.place, SEED, object_space(settings)), SEED)


def test_the_first_look_keeps_clear_of_all_the_space_of_an_object():
    scene = motion_scene(CELL, SPACE)
    views = first_look_views(CELL)
    assert len(views) == 3
    for view in views:
        path = [CELL.robot.home_rad, view.joints_rad]
        assert check_path(scene, path, CELL.scan.min_clearance_m).is_clear


@pytest.mark.parametrize("name", ["mug", "bottle", "tray"])
def test_a_small_object_is_scanned_from_the_fixed_views(name):
    with opened(builtin_object(name)) as cell:
        plan = plan_scan(cell, Reporter())
    assert plan.views_rad == CELL.scan.views_rad
    assert plan.crop_box == plan.keep_out == CELL.place.crop_box


def test_fixed_views_stay_a_choice_and_take_no_first_look():
    fixed = CELL.model_copy(update={"scan": CELL.scan.model_copy(update={"views": "fixed"})})
    assert object_space(fixed) == fixed.place.crop_box
    moves = []
    with opened(builtin_object("mug"), fixed) as cell:
        cell.robot = WatchedRobot(cell.robot, before=moves.append)
        assert plan_scan(cell, Reporter()).views_rad == fixed.scan.views_rad
    assert not moves
    with pytest.raises(InputError, match="does not fit"):
        opened(cylinder(0.075, 0.40), fixed)


def test_an_object_that_is_too_large_is_refused_after_the_first_look():
    tall = cylinder(0.08, 0.46)
    stand = np.eye(4)
    stand[:3, 3] = CELL.place.platform_center_m
    table_m = np.array([*CELL.place.platform_center_m[:2], CELL.place.table_height_m])
    moves = []
    with open_cell(CELL, World(transform_mesh(tall, stand), table_m), SEED) as cell:
        cell.robot = WatchedRobot(cell.robot, before=moves.append)
        with pytest.raises(InputError, match=r"too large .* at most 480 x 400 x 420 mm") as refusal:
            plan_scan(cell, Reporter())
    assert len(moves) == 3
    assert "\n" not in str(refusal.value)


def test_a_simulated_object_that_is_too_large_is_refused_before_anything_moves():
    with pytest.raises(InputError, match=r"500 x 400 x 300 mm does not fit .* space for 460 x 380 x 410 mm"):
        opened(open_box(0.5, 0.4, 0.3))


@pytest.mark.system
def test_planned_views_are_reached_from_home_and_keep_clear_of_the_object():
    mesh = cylinder(0.075, 0.40)
    with opened(mesh) as cell:
        plan = plan_scan(cell, Reporter())
        scene = cell_for_plan(cell, plan).scene
    true = placed(mesh)
    assert (true.aabb_min_m[:2] > plan.keep_out.min_m[:2]).all()
    assert (true.aabb_max_m < plan.keep_out.max_m).all()
    assert (np.array(plan.crop_box.max_m) >= plan.keep_out.max_m).all()
    assert len(plan.views_rad) == 24
    for joints_rad in plan.views_rad:
        path = [CELL.robot.home_rad, joints_rad]
        assert check_path(scene, path, CELL.scan.min_clearance_m).is_clear


@pytest.mark.system
def test_a_box_as_large_as_the_platform_is_scanned():
    mesh = open_box(0.40, 0.36, 0.40)
    scan = simulate_scan(mesh, SEED, Reporter(), cell=simulated_cell())
    true = placed(mesh)
    surface = reconstruct(scan, Parameters().reconstruction, Reporter()).mesh
    assert len(scan.frames) == 24
    assert floor_heights_m(surface, true) == pytest.approx(floor_heights_m(true, true), abs=INSIDE_M)
    # The side away from the arm's base is out of its reach.
    assert surface.aabb_max_m[1] == pytest.approx(true.aabb_max_m[1], abs=SEEN_M)
    assert surface.aabb_max_m[2] == pytest.approx(true.aabb_max_m[2], abs=SEEN_M)
    np.testing.assert_allclose(surface.aabb_min_m, true.aabb_min_m, atol=UNSEEN_M)
    np.testing.assert_allclose(surface.aabb_max_m, true.aabb_max_m, atol=UNSEEN_M)
    assert SurfaceDistance(true).of_m(surface.vertices_m).mean() < 0.002
