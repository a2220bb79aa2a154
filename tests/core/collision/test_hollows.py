import numpy as np
import pytest
import trimesh
from scipy.ndimage import gaussian_filter

from core.collision import simplify
from core.collision.hollows import Hollows
from core.imagination.capacity.water import find_basin
from core.mesh import TriangleMesh
from core.mesh_topology import topology
from core.reconstruction.tsdf import extract_surface, largest_piece

VOXEL_M = 0.0015


def torn_cup(seed: int, torn: float) -> TriangleMesh:
    """A rough cup, 70 mm wide and 90 high, as a scan leaves it: its thin wall is torn near the foot.

    Args:
        seed: of where, and of the roughness.
        torn: share of the wall between 5 and 30 mm above the foot that is missing.
    """
    radius, height, wall = 0.035, 0.09, 0.0022
    origin_m = np.array([-0.0421, -0.0422, -0.0043])
    x, y, z = np.meshgrid(
        *(origin_m[a] + VOXEL_M * np.arange(n) for a, n in enumerate((56, 56, 66))), indexing="ij"
    )
    generator = np.random.default_rng(seed)
    tears = gaussian_filter(generator.normal(size=x.shape), 2.5)
    tears_m = 0.003 * (tears - np.quantile(tears, 1 - torn)) / tears.std()
    from_axis = np.hypot(x, y)
    side = np.maximum.reduce([np.abs(from_axis - radius) - wall / 2, -z, z - height])
    side = np.where((z > 0.005) & (z < 0.03), np.maximum(side, tears_m), side)
    floor = np.maximum(from_axis - radius, np.abs(z - 0.0015) - 0.0015)
    distance = np.minimum(side, floor) + generator.normal(0, 0.0003, x.shape)
    return largest_piece(
        extract_surface((distance / 0.006).clip(-1, 1).astype(np.float32), origin_m, VOXEL_M)
    )


@pytest.mark.parametrize(("seed", "torn", "n_faces"), [(1, 0.25, 1000), (6, 0.2, 2000)])
def test_gaps_in_a_thin_wall_do_not_grow_until_candies_pass(seed: int, torn: float, n_faces: int) -> None:
    """By nearness alone 2250 and 2000 faces would do, of which candies would be held nowhere."""
    cup = torn_cup(seed, torn)
    assert topology(cup).euler < -50
    held_ml = find_basin(cup, 0.0132, 1.0, 500_000).candies_ml
    assert held_ml > 250
    coarse = simplify(cup, n_faces)
    assert len(coarse.faces) < 5 * n_faces
    assert find_basin(coarse, 0.0132, 1.0, 500_000).candies_ml > 0.9 * held_ml


def test_hollows_are_kept_by_the_surface_itself_and_not_without_a_wall() -> None:
    cup = torn_cup(0, 0.0)
    hollows = Hollows.of(cup)
    # The centres of balls 13 and 10 mm thick in a cup 67.8 mm wide and 87 deep.
    expected_m3 = [np.pi * (0.0339 - r) ** 2 * (0.087 - r) for r in (0.0065, 0.005)]
    np.testing.assert_allclose(hollows.volumes_m3, expected_m3, rtol=0.1)
    assert hollows.are_kept_by(cup)
    half = TriangleMesh(cup.vertices_m, cup.faces[cup.vertices_m[cup.faces, 0].mean(axis=1) < 0.01])
    assert not hollows.are_kept_by(half)


@pytest.mark.parametrize(("lost_face", "euler"), [(False, 0), (True, -1)])
def test_a_handle_makes_eulers_number_less_by_two_and_a_hole_in_the_surface_by_one(lost_face, euler) -> None:
    ring = trimesh.creation.torus(0.04, 0.01)
    faces = np.asarray(ring.faces, dtype=np.int64)
    assert topology(TriangleMesh(np.asarray(ring.vertices), faces[int(lost_face) :])).euler == euler
