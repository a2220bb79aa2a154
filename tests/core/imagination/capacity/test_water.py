import numpy as np
import pytest
import trimesh

from core.imagination.capacity.water import find_basin
from core.mesh import TriangleMesh
from core.mesh_topology import join
from tests.core.imagination.capacity.conftest import open_box, polygon_share, turned
from tests.core.imagination.conftest import box

CANDY_M = 0.0132
POINTS = 400_000


def basin_of(mesh: TriangleMesh, candy_m: float = CANDY_M):
    return find_basin(mesh, candy_m, 1.0, POINTS)


@pytest.mark.parametrize("wall_m", [0.0005, 0.002, 0.012])
def test_a_box_holds_its_inside_however_thick_its_walls(wall_m):
    basin = basin_of(open_box((0.08, 0.05, 0.04), wall_m))
    assert basin.water_ml == pytest.approx(160, rel=0.02)
    assert basin.candies_ml == pytest.approx(160, rel=0.04)
    assert basin.water_level_m == pytest.approx(wall_m + 0.04, abs=0.001)


def test_a_box_turned_about_z_holds_the_same():
    mesh = open_box((0.08, 0.05, 0.04), 0.002)
    c, s = np.cos(0.5), np.sin(0.5)
    turned_box = TriangleMesh(mesh.vertices_m @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T, mesh.faces)
    assert basin_of(turned_box).water_ml == pytest.approx(160, rel=0.02)


def test_winding_does_not_matter():
    mesh = open_box((0.08, 0.05, 0.04), 0.002)
    inside_out = TriangleMesh(mesh.vertices_m, mesh.faces[:, ::-1])
    assert basin_of(inside_out).water_ml == basin_of(mesh).water_ml


def test_cylinder_and_cone():
    cup = turned([(0, 0), (0.042, 0), (0.042, 0.082), (0.04, 0.082), (0.04, 0.002), (0, 0.002)])
    assert basin_of(cup).water_ml == pytest.approx(polygon_share() * np.pi * 40**2 * 80 / 1000, rel=0.02)
    cone = turned([(0, 0), (0.032, 0), (0.062, 0.062), (0.06, 0.062), (0.03, 0.002), (0, 0.002)])
    true = polygon_share() * np.pi * 60 / 3 * (60**2 + 60 * 30 + 30**2) / 1000
    basin = basin_of(cone)
    assert basin.water_ml == pytest.approx(true, rel=0.02)
    # Half of the volume stands higher than half of the height: it is narrow below.
    half = basin.level_m(basin.candies_ml / 2)
    assert 0.033 < half < 0.042
    assert basin.mouth_m == pytest.approx(2 * (0.03 + half / 2), rel=0.1)


def test_a_belly_wider_than_its_mouth_is_filled_under_its_shoulder():
    outside = [(0, 0), (0.05, 0), (0.05, 0.06), (0.03, 0.06), (0.03, 0.08)]
    inside = [(0.028, 0.08), (0.028, 0.058), (0.048, 0.058), (0.048, 0.002), (0, 0.002)]
    jar = turned([*outside, *inside])
    true = polygon_share() * np.pi * (48**2 * 56 + 28**2 * 22) / 1000
    basin = basin_of(jar)
    assert basin.water_ml == pytest.approx(true, rel=0.02)
    assert basin.mouth_m == pytest.approx(0.056, rel=0.1)
    seen = basin.hollow_map
    # As wide as its mouth, and the middle of it as far from the edge; held, though, under the shoulder, too.
    assert seen.is_open.sum() * seen.pitch_m**2 == pytest.approx(np.pi * 0.028**2, rel=0.1)
    middle, below_shoulder = np.array([[0.0, 0.0]]), np.array([[0.04, 0.0]])
    assert seen.room_at(middle)[0] == pytest.approx(0.028, abs=0.002)
    assert seen.room_at(below_shoulder)[0] == 0 and np.isfinite(seen.rim_at(below_shoulder)[0])


def test_what_lies_across_a_mouth_is_in_the_way_of_what_falls_though_candies_lie_below_it():
    handle = box((0.035, -0.003, 0.07), (0.045, 0.063, 0.075))
    seen = basin_of(join((open_box((0.08, 0.06, 0.05), 0.003), handle))).hollow_map
    below, beside = np.array([[0.04, 0.03]]), np.array([[0.0175, 0.03]])
    assert np.isfinite(seen.rim_at(below)[0]) and seen.room_at(below)[0] == 0
    assert seen.room_at(beside)[0] == pytest.approx(0.0175, abs=0.0015)


def test_a_tube_open_below_and_an_upturned_cup_hold_nothing():
    tube = turned([(0.042, 0), (0.042, 0.08), (0.04, 0.08), (0.04, 0), (0.042, 0)])
    cup = turned([(0, 0), (0.042, 0), (0.042, 0.082), (0.04, 0.082), (0.04, 0.002), (0, 0.002)])
    upturned = TriangleMesh(cup.vertices_m * [1, 1, -1], cup.faces)
    for mesh in (tube, upturned):
        basin = basin_of(mesh)
        assert (basin.water_ml, basin.candies_ml) == (0, 0)
        assert np.isnan(basin.water_level_m)
        assert np.isnan(basin.level_m(10.0))


@pytest.mark.parametrize(("width_m", "stops_candies"), [(0.008, True), (0.030, False)])
def test_a_notch_lets_water_out_and_candies_if_it_is_wide(width_m, stops_candies):
    basin = basin_of(open_box((0.08, 0.06, 0.05), 0.003, notch_m=(width_m, 0.03)))
    assert basin.water_ml == pytest.approx(80 * 60 * 20 / 1000, rel=0.05)
    assert basin.water_level_m == pytest.approx(0.023, abs=0.001)
    expected_m = 0.053 if stops_candies else 0.023
    assert basin.rim_m == pytest.approx(expected_m, abs=0.003)
    expected_ml = 240 if stops_candies else 96
    assert basin.candies_ml == pytest.approx(expected_ml, rel=0.12)


def test_a_groove_too_narrow_for_a_candy_holds_water_only():
    basin = basin_of(open_box((0.10, 0.008, 0.03), 0.004))
    assert basin.water_ml == pytest.approx(24, rel=0.1)
    # A candy rests on its edges and dips in a little.
    assert basin.candies_ml < 0.2 * basin.water_ml
    assert basin.narrow_ml > 0.8 * basin.water_ml


def test_what_a_box_lies_against():
    around = basin_of(open_box((0.08, 0.05, 0.04), 0.002)).around
    assert around.floor_m2 == pytest.approx(0.08 * 0.05, rel=0.05)
    # Upright walls are taken as turned any way: along the axes they count pi / 4.
    assert around.side_m2 == pytest.approx(np.pi / 4 * 2 * (0.08 + 0.05) * 0.04, rel=0.1)


def test_the_level_rises_with_the_volume_up_to_the_rim():
    basin = basin_of(open_box((0.08, 0.05, 0.04), 0.002))
    levels = [basin.level_m(ml) for ml in np.linspace(0, 200, 21)]
    assert (np.diff(levels) >= 0).all()
    assert basin.level_m(80) == pytest.approx(0.02, abs=0.001)
    assert basin.level_m(1000) == pytest.approx(0.04, abs=0.0015)


@pytest.mark.parametrize("size", [1, 3])
def test_a_rough_wall_with_a_pinhole_costs_candies_nothing(size):
    """Nor a large one, of which the lattice is coarse."""
    smooth = turned([(0, 0), (0.042, 0), (0.042, 0.082), (0.04, 0.082), (0.04, 0.002), (0, 0.002)])
    fine = trimesh.Trimesh(smooth.vertices_m, smooth.faces).subdivide_to_size(0.003)
    rough = fine.vertices + np.random.default_rng(0).normal(0, 0.0005, fine.vertices.shape)
    in_wall = (np.abs(fine.triangles_center - [0.04, 0, 0.01]) < [0.004, 0.0015, 0.0015]).all(axis=1)
    assert in_wall.any()
    holed = TriangleMesh(np.asarray(size * rough), np.asarray(fine.faces[~in_wall], dtype=np.int64))
    basin = basin_of(holed)
    assert basin.water_ml < size**3 * 60
    assert basin.candies_ml == pytest.approx(size**3 * np.pi * 40**2 * 80 / 1000, rel=0.05)
