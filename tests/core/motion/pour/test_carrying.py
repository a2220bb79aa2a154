import numpy as np
import pytest

from core.motion.clearance import axis_aligned_obstacle
from core.motion.kinematics import branch_of, inverse_kinematics, singularity_measure
from core.motion.pour.carrying import Carrying, Stretch, clear_paths, find_lattice, place_grasps, place_of
from core.motion.pour.scene import PourScene
from core.motion.pour.station import find_grips
from tests.core.motion.pour.stage import POURING, box_m, shipped_cell

CELL = shipped_cell()
BRANCH = int(branch_of(CELL.arm, CELL.home_rad))


@pytest.fixture(scope="module")
def scene() -> PourScene:
    return PourScene(CELL, box_m("mug"), POURING.cup)


@pytest.fixture(scope="module")
def lattice(scene):
    return find_lattice(scene, BRANCH)


def test_place_and_back():
    position, azimuth = np.array([-0.3, 0.2, 0.4]), 2.5
    pose = place_grasps(place_of(position, azimuth)[None])[0]
    assert pose[:3, 3] == pytest.approx(position)
    assert pose[:2, 0] == pytest.approx([np.cos(azimuth), np.sin(azimuth)])
    assert pose[2, 2] == 1


def test_placements_are_clear_upright_and_on_the_branch(scene, lattice):
    poses = place_grasps(lattice.places)
    result = inverse_kinematics(CELL.arm, scene.flange_poses(poses), (BRANCH,))
    joints = result.joints_rad[:, 0]
    assert len(poses) > 100
    assert result.found.all()
    assert scene.hand.clearance(joints).distance_m.min() >= CELL.limits.min_clearance_m
    assert singularity_measure(CELL.arm, joints).min() >= CELL.limits.min_singularity
    cups = scene.held_cups(joints)
    assert cups[:, 2, 2] == pytest.approx(1)
    assert scene.cup_to_boxes(cups).min() >= CELL.limits.cup_clearance_m


def test_neighbours_are_near_and_clear_between(scene, lattice):
    start, end = lattice.net.nonzero()
    step = lattice.places[end] - lattice.places[start]
    step[:, [0, 3]] -= 2 * np.pi * np.round(step[:, [0, 3]] / (2 * np.pi))
    assert ((np.abs(step) > 1e-9).sum(axis=1) == 1).all()
    half_way = place_grasps(lattice.places[start] + step / 2)[:, None]
    assert clear_paths(scene, BRANCH, half_way).all()


def test_carrying_leads_to_every_placement_it_promises(scene, lattice):
    (grip,) = [grip for grip in find_grips(scene, CELL.home_rad) if grip.branch == BRANCH]
    carrying = Carrying(scene, grip, lattice)
    reached = np.flatnonzero(np.isfinite(carrying.cost_rad))
    paths = [(node, carrying.to(int(node))) for node in reached[::20]]
    assert len(reached) > len(lattice.places) / 2
    assert sum(path is not None for _, path in paths) > 0.8 * len(paths)
    for node, path in paths:
        for stretch in path or ():
            assert clear_paths(scene, BRANCH, stretch.coarse[None]).all()
        if path:
            assert path[-1].poses(np.ones(1))[0] == pytest.approx(
                place_grasps(lattice.places[[node]])[0], abs=1e-9
            )


def test_stretch_keeps_the_cup_upright_and_ends_where_it_should():
    stretch = Stretch(np.array([0.1, 0.4, 0.3, 1.0]), np.array([1.2, 0.6, 0.3, 0.5]))
    poses = stretch.poses(np.linspace(0, 1, 20))
    assert poses[:, 2, 2] == pytest.approx(1)
    assert np.hypot(*poses[[0, -1], :2, 3].T) == pytest.approx([0.4, 0.6])
    length = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).sum()
    assert length <= stretch.length_m
    assert stretch.rotation_rad == pytest.approx(0.6)


def test_nowhere_to_go_is_no_error():
    around = axis_aligned_obstacle("fog", (-2, -2, 0.3), (2, 2, 2))
    cell = shipped_cell(obstacles=(*CELL.obstacles, around))
    scene = PourScene(cell, box_m("glass"), POURING.cup)
    empty = find_lattice(scene, BRANCH)
    cost, before = empty.paths_from(np.zeros(0, dtype=np.int64))
    assert len(empty.places) == len(cost) == len(before) == 0
