from __future__ import annotations

import numpy as np
import pytest

from app.gui.theme import LIGHT
from app.gui.views.scene.ground import Ground
from app.gui.views.scene.occlusion import ambient_light, surface_points_m
from app.gui.views.scene.parts import prepare_mesh
from app.gui.views.scene.shapes import box_mesh
from tests.benchmarks.scene_speed import mug

BOX = box_mesh((-0.05, -0.05, 0), (0.05, 0.05, 0.1))


def ground(casters_m=(), half_m=(0.2, 0.2)):
    casters = np.asarray(casters_m, dtype=float).reshape(-1, 3)
    return Ground((0, 0, 0), half_m, casters, grid_m=0.01, fades=True)


def shadow(made):
    return made.layer.parts[0].shadow


def test_what_stands_on_the_ground_has_its_shadow_there_and_not_far_away():
    dark = shadow(ground(surface_points_m(*BOX, 20_000))).astype(int)
    n = len(dark)
    assert dark[n // 2, n // 2] > 60
    beside = dark[n // 2, round(n * (0.5 + 0.052 / 0.4))]
    assert 20 < beside < dark[n // 2, n // 2] + 1
    assert dark[2, 2] == 0


def test_what_hangs_in_the_air_has_no_contact_shadow():
    high = surface_points_m(BOX[0] + (0, 0, 1.0), BOX[1], 5_000)
    assert shadow(ground(high)).max() == 0


def test_a_shadow_lies_where_its_caster_is_along_each_axis():
    points = surface_points_m(BOX[0] * 0.2 + (0.1, -0.05, 0), BOX[1], 5_000)
    rows, columns = np.nonzero(shadow(ground(points)) > 40)
    n = len(shadow(ground()))
    assert (columns.mean() + 0.5) / n == pytest.approx(0.5 + 0.1 / 0.4, abs=0.01)
    assert (rows.mean() + 0.5) / n == pytest.approx(0.5 - 0.05 / 0.4, abs=0.01)


def test_candies_that_lie_there_have_shadows_and_those_above_have_none():
    made = ground()
    made.shade_candies(np.array([(0.1, 0.1, 0.1), (np.nan,) * 3]), 0.006)
    assert shadow(made).max() == 0
    revision = made.layer.parts[0].revision
    made.shade_candies(np.array([(0.1, 0.1, 0.003), (np.nan,) * 3]), 0.006)
    assert shadow(made).max() > 40
    assert made.layer.parts[0].revision > revision


def test_a_ground_is_no_part_of_what_is_brought_into_view():
    assert len(ground().layer.outline_m()) == 0


def test_points_on_a_surface_are_as_many_as_wanted_and_as_dense_everywhere():
    points = surface_points_m(*box_mesh((0, 0, 0), (1, 1, 2)), 10_000)
    assert len(points) == 10_000
    assert (np.abs(points[:, 2] - 2) < 1e-9).mean() == pytest.approx(0.1, abs=0.01)
    on_top = points[np.abs(points[:, 2] - 2) < 1e-9]
    assert (on_top[:, 0] < 0.5).mean() == pytest.approx(0.5, abs=0.05)


def test_the_inside_of_a_cup_is_darker_than_its_outside_and_a_box_is_light_all_over():
    vertices, faces = mug(10_000)
    light = ambient_light(vertices, faces)
    radius, height = np.linalg.norm(vertices[:, :2], axis=1), vertices[:, 2]
    inside = (radius < 0.0385) & (height > 0.006) & (height < 0.03)
    outside = (radius > 0.041) & (height > 0.02) & (height < 0.08)
    assert np.median(light[inside]) < 0.75 < 0.9 < np.median(light[outside])
    assert ambient_light(*BOX).min() > 0.95


def test_shading_darkens_colours_and_leaves_the_surface_alone():
    plain, shaded = (prepare_mesh(*mug(2_000), is_shaded=is_shaded) for is_shaded in (False, True))
    assert plain.light is None and (plain.vertices_m == shaded.vertices_m).all()
    from app.gui.views.scene.layers import mesh_layer

    before, after = (mesh_layer(one, "body", 0.5).parts[0].paint.colors(LIGHT) for one in (plain, shaded))
    assert after.shape == (len(shaded.vertices_m), 4)
    assert (after[:, :3] <= before[:3] + 1e-6).all() and (after[:, 3] == before[3]).all()


def test_nothing_has_all_the_light():
    assert (ambient_light(np.zeros((3, 3)), np.empty((0, 3))) == 1).all()
