import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.geometry import rotation_error
from core.mesh import TriangleMesh
from hardware.cell import read_cell
from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object
from hardware.simulation.placing import place_on_platform, transform_mesh, world_with

PLACE = read_cell().place


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(list(BUILTIN_OBJECTS)), st.integers(0, 2**31 - 1))
def test_every_object_stands_upright_inside_the_box_on_the_platform(name: str, seed: int) -> None:
    mesh = builtin_object(name)
    T = place_on_platform(mesh, seed, PLACE)
    assert rotation_error(T[:3, :3]) < 1e-9
    np.testing.assert_allclose(T[2, :3], [0, 0, 1])
    placed = transform_mesh(mesh, T)
    assert placed.aabb_min_m[2] == pytest.approx(PLACE.platform_height_m)
    assert (placed.aabb_min_m > np.array(PLACE.crop_min_m) + 0.0099).all()
    assert (placed.aabb_max_m < np.array(PLACE.crop_max_m) - 0.0099).all()
    middle = (placed.aabb_min_m + placed.aabb_max_m) / 2
    assert np.abs(middle - PLACE.platform_center_m)[:2].max() <= 0.03 + 1e-9


def test_where_the_objects_own_frame_lies_does_not_matter() -> None:
    mesh = builtin_object("mug")
    moved = mesh.translated(np.array([5.0, -3.0, 2.0]))
    here = transform_mesh(mesh, place_on_platform(mesh, 4, PLACE))
    there = transform_mesh(moved, place_on_platform(moved, 4, PLACE))
    np.testing.assert_allclose(here.vertices_m, there.vertices_m, atol=1e-9)


def test_each_seed_places_it_elsewhere_and_the_same_one_there_again() -> None:
    mesh = builtin_object("mug")
    poses = [place_on_platform(mesh, seed, PLACE) for seed in (0, 1, 2, 0)]
    np.testing.assert_array_equal(poses[0], poses[3])
    assert np.abs(poses[0] - poses[1]).max() > 0.01
    assert np.abs(poses[1] - poses[2]).max() > 0.01


def test_an_object_too_large_for_the_cell_is_a_sentence() -> None:
    block = builtin_object("block")
    with pytest.raises(InputError, match=r"600 x 400 x 300 mm does not fit .* space for 460 x 380 x 260 mm"):
        place_on_platform(TriangleMesh(block.vertices_m * 5, block.faces), 0, PLACE)


def test_the_platform_is_not_seen_but_the_table_is() -> None:
    """Rays straight down beside the object, over the platform, meet the table below it."""
    world = world_with(builtin_object("mug"), PLACE, 0)
    over = np.array([*PLACE.platform_center_m[:2], 1.0])
    for corner in ((-0.19, -0.17), (0.19, 0.17), (-0.19, 0.17)):
        hits = world.cast(over + np.array([*corner, 0]), np.array([[[0.0, 0.0, -1.0]]]))
        assert hits.points_m[0, 0, 2] == pytest.approx(PLACE.table_height_m, abs=1e-6)
        assert not hits.on_object.any()
    mesh = transform_mesh(builtin_object("mug"), place_on_platform(builtin_object("mug"), 0, PLACE))
    rim = mesh.vertices_m[mesh.vertices_m[:, 2].argmax()]
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    over_rim = rim + (middle - rim) * [0.01, 0.01, 0]
    hits = world.cast(np.array([*over_rim[:2], 1.0]), np.array([[[0.0, 0.0, -1.0]]]))
    assert hits.on_object.all()
    assert hits.points_m[0, 0, 2] > PLACE.platform_height_m
