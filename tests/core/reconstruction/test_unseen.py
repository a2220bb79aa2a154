from __future__ import annotations

import numpy as np
import pytest

from core.imagination.capacity.openings import has_opening_below
from core.imagination.capacity.water import find_basin
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from core.reconstruction.unseen import THINNEST_WALL_M, find_unseen_inside
from hardware.simulation.objects import builtin_object
from tests.core.imagination.capacity.conftest import turned
from tests.core.quality.studio import LOW_RINGS, VOXEL_M, on_platform, shaft, tube


def test_an_unseen_shaft_may_be_hollow_but_for_walls_and_a_floor_as_thin_as_they_can_be():
    unseen = find_unseen_inside(shaft(0.1), platform_height_m=0.0)
    room = unseen.room(VOXEL_M)
    assert room.sum(axis=(0, 1)).max() == 15 * 15
    assert not room[:, :, : round(THINNEST_WALL_M / VOXEL_M)].any()
    top = np.nonzero(unseen.in_volume(room).any(axis=(0, 1)))[0][-1]
    assert top == 0.1 / VOXEL_M - 1


def test_an_unseen_shaft_may_have_no_floor():
    volume = shaft(0.1)
    unseen = find_unseen_inside(volume, platform_height_m=0.01)
    through = unseen.way_through(volume)
    assert through is not None
    assert (through[:, :, : unseen.first_layer].sum(axis=(0, 1)) == 11 * 11).all()
    assert through[:, :, unseen.first_layer : 20].any(axis=2).sum() == 15 * 15, "but for a thin wall"


def test_a_floor_that_was_seen_stays():
    volume = shaft(0.1, floor_m=0.02)
    unseen = find_unseen_inside(volume, platform_height_m=0.0)
    assert unseen.room(VOXEL_M).any()
    assert unseen.way_through(volume) is None


@pytest.mark.parametrize(("wide", "is_way"), [(1, False), (3, True)])
def test_a_ring_at_the_foot_of_a_wall_is_a_way_through_where_a_candy_could_pass(wide, is_way):
    volume = shaft(0.1)
    steps = np.arange(31) - 15
    across = np.maximum(abs(steps[:, None]), abs(steps))
    seen = across <= 5 - wide
    volume.weight[seen] = 1
    volume.distance[seen, 4:] = 1.0
    volume.distance[seen, :4] = -0.5
    volume.weight[seen, :3] = 0  # the core of the floor
    unseen = find_unseen_inside(volume, platform_height_m=0.0)
    assert unseen.region[:, :, 0].sum() * VOXEL_M**2 > 1e-3, (
        "much of what lies just above the platform is unseen"
    )
    assert (unseen.way_through(volume) is not None) == is_way


def test_a_wall_that_was_seen_from_both_sides_is_as_thick_as_it_looks():
    volume = shaft(0.1)
    volume.weight[11:20, 11:20, :25] = 1
    volume.distance[11:20, 11:20, :25] = 1.0
    unseen = find_unseen_inside(volume, platform_height_m=0.0)
    assert unseen.region.any() and not unseen.assumed[:, :, :24].any()


def test_a_lid_that_was_seen_from_above_is_there_however_little_was_seen_below_it():
    volume = shaft(0.104)
    lid = slice(10, 21), slice(10, 21), slice(26, 30)
    volume.distance[lid] = -0.5
    volume.distance[20, 10:21, 26:30] = 1.0  # a slit at one side, through which the views look
    unseen = find_unseen_inside(volume, platform_height_m=0.0)
    room = unseen.in_volume(unseen.room(VOXEL_M))
    assert room[10:21, 10:21, 25].all(), "below it all may be hollow, and it may be thin"
    assert unseen.in_volume(unseen.assumed)[10:15, 10:21, 26:29].all()
    assert not room[:, :, 29].any()


@pytest.mark.parametrize(("columns", "is_hole", "n_freed"), [(1, True, 3 * 11), (1, False, 0), (2, True, 0)])
def test_the_little_that_was_not_seen_beside_a_hole_is_taken_for_a_part_of_it(columns, is_hole, n_freed):
    """1.4 and 2.8 ml above the platform's layer; in 2 ml two candies have room."""
    volume = shaft(0.0)
    volume.weight[10 : 10 + columns, 10:21, :3] = 0
    unseen = find_unseen_inside(volume, platform_height_m=0.0)
    freed = unseen.beside_holes(volume, np.full(volume.weight.shape[:2], is_hole))
    assert freed.sum() == n_freed
    assert not freed[volume.weight > 0].any()


def reconstructed(mesh) -> Reconstruction:
    return reconstruct(on_platform(mesh).scan(LOW_RINGS), ReconstructionParameters(), Reporter())


@pytest.fixture(scope="module")
def deep_tube() -> Reconstruction:
    return reconstructed(tube(0.04, 0.15))


def test_a_deep_vessel_is_told_apart_from_a_solid_one_and_from_a_pipe(deep_tube):
    unseen = deep_tube.unseen
    assert unseen is not None and unseen.leaky is not None
    assert unseen.unseen_ml > 30
    inside_ml = np.pi * 0.02**2 * 0.15 * 1e6
    more_ml = 1e6 * (deep_tube.mesh.volume_m3 - unseen.roomy.volume_m3)
    assert more_ml == pytest.approx(unseen.unseen_ml, rel=0.25)
    assert more_ml < inside_ml
    assert unseen.leaky.volume_m3 < unseen.roomy.volume_m3


def test_it_survives_a_session(deep_tube, tmp_path):
    deep_tube.save(tmp_path)
    loaded = Reconstruction.load(tmp_path)
    assert loaded.unseen is not None and loaded.unseen.leaky is not None
    assert loaded.unseen.unseen_ml == deep_tube.unseen.unseen_ml
    assert np.array_equal(loaded.unseen.leaky.faces, deep_tube.unseen.leaky.faces)


def test_a_spout_is_not_narrowed_by_what_slanting_views_did_not_see_of_it():
    """20 mm wide and 40 long: with a crescent at its end left solid, nothing wider than 9 mm fell through."""
    corners = [(0.05, 0.085), (0.01, 0.04), (0.01, 0.0), (0.013, 0.0), (0.013, 0.04), (0.053, 0.085)]
    scan = on_platform(turned([*corners, corners[0]])).scan()
    mesh = reconstruct(scan, ReconstructionParameters(), Reporter()).mesh
    hollows = find_basin(mesh, 0.02, 1.0, 200_000).hollow_map
    assert has_opening_below(mesh, mesh.vertices_m[:, :2], hollows, 0.013)


@pytest.mark.parametrize("name", ["mug", "block"])
def test_nothing_is_unseen_where_the_views_looked_everywhere(name, tmp_path):
    found = reconstructed(builtin_object(name))
    assert found.unseen is None
    found.save(tmp_path)
    assert Reconstruction.load(tmp_path).unseen is None
