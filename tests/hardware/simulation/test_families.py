import re
from dataclasses import replace
from math import pi

import numpy as np
import pytest
import trimesh

from core.errors import InputError
from core.geometry import make_pose, rotation_x
from core.imagination.capacity.water import find_basin
from core.mesh import TriangleMesh
from core.mesh_topology import join
from hardware.simulation.families.bodies import pool
from hardware.simulation.families.catalogue import FAMILIES, families_of, member, members
from hardware.simulation.families.forms import Block, disc, slab, straight, tub, vessel, volume_below_m3
from hardware.simulation.families.truth import Form, Gap, Hole, candies_in, solid, truth_of

SEED, N_TRIED = 0, 3
LATTICE_POINTS = 1_000_000
CANDY_M, CANDY_HEIGHT_M = 0.0132, 0.007


def layer_m(mesh: TriangleMesh) -> float:
    """Height of a layer of the lattice that `find_basin` lays, at least a quarter of a millimetre."""
    return max((float(np.prod(mesh.extents_m)) / 0.5 / LATTICE_POINTS) ** (1 / 3), 0.0005) / 2


def tight(one) -> TriangleMesh:
    """The mesh with its drain closed, flush with the floor: water would find any hole."""
    if not one.truth.hole_mm:
        return one.mesh
    floor_m = one.mesh.aabb_max_m[2] - one.truth.depth_mm / 1e3
    radius_m = one.mesh.extents_m[0] / 2 - one.truth.wall_mm / 2e3
    if one.family.name != "sieve":
        radius_m = one.truth.hole_mm / 2e3 + 0.0005
    return join((one.mesh, disc(radius_m, -0.002, max(floor_m, 0.0))))


@pytest.mark.parametrize("name", FAMILIES)
def test_members_are_closed_and_rest_on_the_ground(name):
    for number in range(N_TRIED):
        one = member(FAMILIES[name], number, SEED)
        body = trimesh.Trimesh(one.mesh.vertices_m, one.mesh.faces, process=False)
        assert body.is_watertight, one.name
        assert body.is_winding_consistent, one.name
        assert body.volume > 0, one.name
        assert one.mesh.aabb_min_m[2] == pytest.approx(0, abs=1e-9), one.name
        assert 0.03 <= one.mesh.extents_m.max() <= 0.46, one.name
        assert one.truth.wall_mm >= 0.9, one.name


@pytest.mark.parametrize(
    "number", [0, *(pytest.param(k, marks=pytest.mark.system) for k in range(1, N_TRIED))]
)
@pytest.mark.parametrize("name", [name for name in FAMILIES if name != "basket"])
def test_capacity_is_what_water_fills(name, number):
    """Independently: points in the mesh that water cannot leave. Shallow hollows are as exact as a layer."""
    one = member(FAMILIES[name], number, SEED)
    mesh, truth = tight(one), one.truth
    water_ml = find_basin(mesh, CANDY_HEIGHT_M, 0.05, LATTICE_POINTS).water_ml
    if truth.depth_mm == 0 or truth.capacity_ml < 1:
        assert water_ml < 1.5, one.name
    elif one.truth.mouth_mm > 0:
        within = max(0.02, 1.2 * layer_m(mesh) / (truth.depth_mm / 1e3))
        assert water_ml == pytest.approx(truth.capacity_ml, rel=within), one.name


def test_a_basket_of_narrow_openings_holds_candies_up_to_its_rim():
    narrow = [
        one for one in (member(FAMILIES["basket"], k, SEED) for k in range(12)) if one.truth.hole_mm < 6.5
    ]
    assert narrow
    for one in narrow:
        held_ml = find_basin(one.mesh, CANDY_HEIGHT_M, 0.05, LATTICE_POINTS).candies_ml
        assert held_ml == pytest.approx(one.truth.capacity_ml, rel=0.06), one.name


def test_volumes_of_known_bodies():
    cube = slab((0.2, 0.1, 0.1), (0, 0, 0))
    assert volume_below_m3(cube, 0.04) == pytest.approx(0.2 * 0.1 * 0.04)
    assert volume_below_m3(cube, 1) == pytest.approx(0.002)
    assert volume_below_m3(cube, -1) == 0
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    sphere = TriangleMesh(np.array(ball.vertices), np.array(ball.faces, dtype=np.int64))
    for height in (0.03, 0.1, 0.17):
        cap = pi * height**2 * (0.3 - height) / 3
        assert volume_below_m3(sphere, height - 0.1) == pytest.approx(cap, rel=2e-3)


def test_capacities_of_textbook_vessels():
    circle = 96 / 2 * np.sin(2 * pi / 96)  # of the polygon, instead of pi
    cylinder = vessel(straight(0.04, 0.04, 0.1), 0.002, 0.005)
    depth = cylinder.rim_m - 0.005
    assert cylinder.rim_m == pytest.approx(0.101)
    assert cylinder.capacity_m3 == pytest.approx(circle * 0.038**2 * depth, rel=2e-3)
    box = tub((0.2, 0.1, 0.05), 0.003, 0.004, 0.004)
    assert box.capacity_m3 == pytest.approx(0.194 * 0.094 * 0.046, rel=2e-3)
    cells = Block.of_cells(
        [0, 0.01, 0.11, 0.12], [0, 0.01, 0.06, 0.07], [[0.03] * 3, [0.03, 0.005, 0.03], [0.03] * 3]
    )
    assert cells.capacity_m3(0.03) == pytest.approx(0.1 * 0.05 * 0.025, rel=1e-2)
    assert cells.mesh.volume_m3 + cells.capacity_m3(0.03) == pytest.approx(0.12 * 0.07 * 0.03)


def test_a_tilted_cylinder_loses_what_the_formula_says():
    """A cylinder of radius r, tilted by a, keeps pi r^2 (h - r tan a) while its floor stays under water."""
    upright = vessel(straight(0.04, 0.04, 0.15), 0.001, 0.002)
    angle, radius, depth = 0.5, 0.039, 0.15 - 0.002
    leaning = upright.moved(make_pose(rotation_x(angle), np.zeros(3)))
    assert leaning.capacity_m3 == pytest.approx(pi * radius**2 * (depth - radius * np.tan(angle)), rel=0.01)


def test_a_pool_finds_its_own_bottom_and_level():
    xs = np.linspace(0, 0.1, 301)
    x, y = np.meshgrid(xs, xs, indexing="ij")
    dent = np.hypot(x - 0.05, y - 0.05) / 0.03
    block = Block(xs, xs, 0.03 + 0.02 * np.clip(dent, 0, 1) - 0.1 * np.clip(dent - 1.2, 0, 0.2))
    nearest = int(np.linalg.norm(block.mesh.vertices_m - [0.06, 0.05, 0.036], axis=1).argmin())
    bottom, level, room = pool(block.mesh, nearest)
    assert bottom == pytest.approx(0.03)
    assert level == pytest.approx(0.05)
    assert room == pytest.approx(pi * 0.03**2 * 0.02 / 3, rel=0.02)


BOX = tub((0.1, 0.1, 0.06), 0.003, 0.003, 0.004)


def form(**changed) -> Form:
    return replace(BOX.form(), **changed)


@pytest.mark.parametrize(
    ("changed", "label", "said"),
    [
        ({}, "container", "Holds .* candies below a rim 57 mm"),
        ({"depth_m": 0.0034}, "non-container", "less than half a candy's thickness"),
        ({"depth_m": 0.0036}, "ambiguous", "less than a candy is wide"),
        ({"depth_m": 0.0133}, "container", "13.3 mm above the floor"),
        ({"depth_m": 0.0, "breach_m": 0.02}, "ambiguous", "broken over 20 mm"),
        ({"mouth": Gap(0.011)}, "non-container", "No candy gets in"),
        ({"mouth": Gap(0.03)}, "ambiguous", "no stream of them"),
        ({"mouth": Gap(0.034)}, "container", "mouth of 34 mm"),
        ({"mouth": Gap(0.0055, "slot")}, "non-container", "No candy gets in"),
        ({"mouth": Gap(0.0065, "slot")}, "ambiguous", "no stream of them"),
        ({"hole": Hole(Gap(0.0085, "square"), True)}, "container", "no candy passes its holes of 8.5 mm"),
        ({"hole": Hole(Gap(0.0095, "square"), True)}, "ambiguous", "just stay on holes"),
        ({"hole": Hole(Gap(0.0125, "square"), True)}, "ambiguous", "arch over holes"),
        ({"hole": Hole(Gap(0.0165, "square"), True)}, "non-container", "leave through holes"),
        ({"hole": Hole(Gap(0.03), False)}, "ambiguous", "arch over holes of 30 mm"),
        ({"capacity_m3": 5e-6}, "ambiguous", "holds 4 candies only"),
        ({"capacity_m3": 1e-6}, "non-container", "no room for a candy"),
        ({"capacity_m3": 15e-6}, "ambiguous", "a dent of 2.5 %"),
    ],
)
def test_the_label_follows_from_what_a_candy_can_do(changed, label, said):
    truth = truth_of(form(**changed))
    assert truth.label == label
    assert re.search(said, truth.reason)


def test_a_candy_that_no_round_room_takes_gets_into_a_square_one_aslant():
    truth = member(FAMILIES["compartments"], 12, 2).truth
    width_m = truth.mouth_mm / 1000
    assert truth_of(form(mouth=Gap(width_m))).label == "non-container"
    assert truth.label == truth_of(form(mouth=Gap(width_m, "square"))).label == "ambiguous"


def test_a_solid_body_is_labelled_by_its_reason():
    truth = truth_of(solid(BOX.mesh, 0.01, "it is closed"))
    assert (truth.label, truth.reason, truth.capacity_candies) == ("non-container", "It is closed.", 0)


def test_candies_fill_six_tenths_of_a_large_volume():
    one_m3 = 4 / 3 * pi * (CANDY_M / 2) ** 2 * CANDY_HEIGHT_M / 2
    assert candies_in(1e-3) == pytest.approx(0.6 * 1e-3 / one_m3, abs=1)


@pytest.mark.parametrize("shape", ["round", "square", "slot"])
def test_a_candy_just_passes_a_gap_of_passing_one(shape):
    """A spheroid's outline seen along its edge, turned about that axis, fits between the sides of the gap."""
    angles = np.linspace(0, pi, 721)
    high, long = CANDY_HEIGHT_M / 2, CANDY_M / 2
    extents = {
        "round": 2 * long,
        "square": min(2 * max(_reach(a, long, high), _reach(a + pi / 2, long, high)) for a in angles),
        "slot": 2 * high,
    }
    assert Gap(extents[shape], shape).passing == pytest.approx(1, rel=1e-3)


def _reach(angle, long, high):
    return np.hypot(long * np.cos(angle), high * np.sin(angle))


def test_the_same_seed_gives_the_same_bytes_whatever_else_is_made():
    alone = member(FAMILIES["rough_pot"], 1, 7)
    among = next(one for one in members(tuple(FAMILIES.values()), 80, 7) if one.name == alone.name)
    assert alone.mesh.vertices_m.tobytes() == among.mesh.vertices_m.tobytes()
    assert alone.truth == among.truth
    assert member(FAMILIES["rough_pot"], 1, 8).mesh.vertices_m.tobytes() != alone.mesh.vertices_m.tobytes()


def test_what_grows_is_spread_evenly():
    necks = sorted(member(FAMILIES["bottle"], k, SEED).truth.mouth_mm for k in range(20))
    assert necks[0] < 12
    assert necks[-1] > 64
    assert max(np.diff(necks)) < 6


def test_half_of_the_families_are_for_judging():
    judging = families_of([], "judging")
    development = families_of([], "development")
    assert len(FAMILIES) >= 20
    assert abs(len(judging) - len(development)) <= 1
    assert not {one.name for one in judging} & {one.name for one in development}
    for half in (judging, development):
        labels = {member(one, k, SEED).truth.label for one in half for k in range(3)}
        assert labels == {"container", "non-container", "ambiguous"}


def test_families_are_chosen_by_name():
    assert [one.name for one in families_of(["urn", "cup", "urn"], None)] == ["urn", "cup"]
    with pytest.raises(InputError, match="did you mean 'goblet'"):
        families_of(["gobblet"], None)
    with pytest.raises(InputError, match="None of the families cup is for judging"):
        families_of(["cup"], "judging")
