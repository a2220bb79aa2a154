from math import radians

import numpy as np
import pytest

from core.errors import StageError
from core.geometry import rotation_error, transform_points
from core.imagination.cup import cup_parts, cup_pose, inner_radius_m, pivot_in_cup_m, pour_angle
from core.imagination.packing import pack_cup
from core.imagination.particle_shape import particle_extents_m
from core.parameters import Parameters, apply_settings, load_preset

CUP = Parameters().pouring.cup
PIVOT = np.array([0.3, -0.1, 0.2])


@pytest.mark.parametrize("theta", [0.0, 0.7, 2.5, -1.9])
def test_the_initial_pose_is_equation_6(theta):
    T_world_cup = cup_pose(CUP, PIVOT, theta, 0.0)
    assert rotation_error(T_world_cup[:3, :3]) < 1e-12
    pivot = pivot_in_cup_m(CUP)
    assert transform_points(T_world_cup, pivot) == pytest.approx(PIVOT)
    # l_cup, from the base's inner edge to the pivot, lies level on the ray and points to p_E.
    base_edge = np.array([inner_radius_m(CUP, 0.0), 0, 0])
    l_cup = PIVOT - transform_points(T_world_cup, base_edge)
    assert l_cup / np.linalg.norm(l_cup) == pytest.approx([-np.cos(theta), -np.sin(theta), 0], abs=1e-12)
    # The pivot is the lowest point of the mouth.
    angles = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    rim = np.column_stack([pivot[0] * np.cos(angles), pivot[0] * np.sin(angles), np.full(90, CUP.length_m)])
    assert transform_points(T_world_cup, rim)[:, 2].min() == pytest.approx(PIVOT[2])


def test_the_turn_keeps_the_pivot_and_lifts_the_base():
    base_heights = []
    for gamma in np.radians([0, 20, 45, 62]):
        pose = cup_pose(CUP, PIVOT, 1.0, gamma)
        assert transform_points(pose, pivot_in_cup_m(CUP)) == pytest.approx(PIVOT)
        base_heights.append(pose[2, 3])
    assert (np.diff(base_heights) > 0.01).all()


def test_the_turn_is_a_quarter_sine():
    pouring = load_preset("authors").pouring
    assert pour_angle(pouring, pouring.settle_s) == (0.0, 0.0)
    halfway, rate = pour_angle(pouring, pouring.settle_s + pouring.turn_s / 2)
    assert halfway == pytest.approx(pouring.gamma_0_rad * np.sin(np.pi / 4))
    assert rate > 0
    assert pour_angle(pouring, pouring.settle_s + pouring.turn_s)[0] == pytest.approx(
        radians(45) + CUP.slant_rad
    )


def test_the_parts_are_convex_closed_and_as_large_as_the_cone():
    import trimesh

    parts = [trimesh.Trimesh(part.vertices_m, part.faces, process=False) for part in cup_parts(CUP)]
    assert all(part.is_watertight and part.volume > 0 and part.is_convex for part in parts)
    corners = np.vstack([part.vertices for part in parts])
    assert np.hypot(corners[:, 0], corners[:, 1]).max() == pytest.approx(CUP.mouth_radius_m)
    assert (corners[:, 2].min(), corners[:, 2].max()) == pytest.approx((0, CUP.length_m))


@pytest.mark.parametrize("preset", ["default", "paper", "authors"])
def test_packed_candies_lie_inside_without_touching(preset):
    parameters = load_preset(preset)
    cup = parameters.pouring.cup
    packed = pack_cup(parameters, 0)
    assert len(packed) == parameters.pouring.n_pour
    angles = np.linspace(0, 2 * np.pi, 24)
    extents = particle_extents_m(parameters.particle) / 2
    rim = np.column_stack([np.cos(angles), np.sin(angles), np.ones(24)]) * extents
    surface = packed[:, None, :] + np.vstack([rim, rim * [1, 1, -1]])
    in_cup = transform_points(np.linalg.inv(cup_pose(cup, np.zeros(3), 0.0, 0.0)), surface)
    assert (np.hypot(in_cup[..., 0], in_cup[..., 1]) < inner_radius_m(cup, in_cup[..., 2])).all()
    assert (in_cup[..., 2] > cup.wall_m).all()
    assert (in_cup[..., 2] < cup.length_m).all()
    gaps = np.abs(packed[:, None] - packed[None]) / particle_extents_m(parameters.particle)
    apart = gaps.max(axis=2) + 2 * np.eye(len(packed))
    assert apart.min() >= 1.0
    assert (pack_cup(parameters, 0) == packed).all()
    assert (pack_cup(parameters, 1) != packed).any()


def test_a_cup_too_small_for_n_pour_says_how_many_fit():
    parameters = apply_settings(Parameters(), {"pouring.cup.length_m": 0.03, "pouring.n_pour": 900})
    with pytest.raises(StageError, match=r"cannot hold 900 candies.*room for \d+.*n_pour"):
        pack_cup(parameters, 0)


def test_the_released_pivot_is_3_mm_above_the_inner_rims_lowest_point_when_the_cup_is_ready_to_pour():
    cup = load_preset("authors").pouring.cup
    pose = cup_pose(cup, np.zeros(3), 0.0, 0.0)
    rim_in_cup = np.array([cup.mouth_radius_m - cup.wall_m, 0.0, cup.length_m])
    assert transform_points(pose, rim_in_cup[None])[0] == pytest.approx([0, 0, -0.003], abs=1e-9)
