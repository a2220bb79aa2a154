from __future__ import annotations

import time

import numpy as np
import pytest

from app.gui.theme import DARK, LIGHT
from app.gui.views.scene import ColorScale, prepare_mesh
from app.gui.views.scene.parts import Paint
from app.gui.views.scene.shapes import box_mesh, capsule_mesh
from core.mesh import TriangleMesh
from core.mesh_topology import weld
from tests.awake import in_time
from tests.benchmarks.scene_speed import mug

SCALE = ColorScale("Height", "mm", 10, 20)


def test_a_scale_begins_dark_and_ends_yellow():
    low, high = SCALE.colors([10, 20])
    assert low[:3] == pytest.approx((0.267, 0.005, 0.329), abs=0.005)
    assert high[:3] == pytest.approx((0.993, 0.906, 0.144), abs=0.005)


def test_values_beyond_the_ends_have_the_ends_colours():
    assert (SCALE.colors([-5, 99]) == SCALE.colors([10, 20])).all()


def test_no_value_no_colour():
    assert SCALE.colors([np.nan]).tolist() == [[0, 0, 0, 0]]


def test_a_scale_without_a_span_colours_everything_alike():
    assert len(np.unique(ColorScale("x", "m", 1, 1).colors([0, 1, 2]), axis=0)) == 1


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_paint_follows_the_theme(theme):
    color = Paint(("kept",), opacity=0.5).colors(theme)
    kept = theme.color("kept")
    assert color == pytest.approx((kept.redF(), kept.greenF(), kept.blueF(), 0.5), abs=1e-4)


def test_paint_names_a_colour_for_each_vertex():
    colors = Paint(("kept", "lost"), which=np.array([0, 1, 1], dtype=np.uint8)).colors(LIGHT)
    assert (colors[1] == colors[2]).all()
    assert (colors[0] != colors[1]).any()


def test_paint_without_a_value_falls_back_to_its_name():
    paint = Paint(("body",), values=np.array([15, np.nan], dtype=np.float32), scale=SCALE)
    known, unknown = paint.colors(LIGHT)
    assert known == pytest.approx(SCALE.colors([15])[0])
    assert unknown == pytest.approx(Paint(("body",)).colors(LIGHT))


BALL = weld(TriangleMesh(*capsule_mesh((0, 0, 0), (0, 0, 0), 1.0)))


def test_normals_of_a_ball_point_outwards():
    vertices, faces = BALL.vertices_m, BALL.faces
    mesh = prepare_mesh(3 * vertices + 1, faces)
    assert np.einsum("ij,ij->i", mesh.normals, vertices) == pytest.approx(np.ones(len(vertices)), abs=0.01)


def test_normals_of_a_box_are_those_of_its_sides():
    vertices, faces = box_mesh((0, 0, 0), (1, 2, 3))
    normals = prepare_mesh(vertices, faces).normals
    assert (np.abs(normals).max(axis=1) == 1).all()
    assert np.einsum("ij,ij->i", normals, vertices - (0.5, 1, 1.5)).min() > 0


def test_a_vertex_without_faces_and_a_face_without_area_do_no_harm():
    mesh = prepare_mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0), (5, 5, 5)], [(0, 1, 2)])
    assert np.isfinite(mesh.normals).all()


def test_a_wire_frame_has_each_edge_once():
    vertices, faces = BALL.vertices_m, BALL.faces
    edges = prepare_mesh(vertices, faces, is_wireframe=True).edges
    assert len(edges) == len(vertices) + len(faces) - 2
    assert len(np.unique(np.sort(edges, axis=1), axis=0)) == len(edges)


def test_an_empty_mesh_can_be_prepared():
    mesh = prepare_mesh(np.empty((0, 3)), np.empty((0, 3)), is_wireframe=True)
    assert len(mesh.faces) == len(mesh.edges) == 0


def test_values_come_with_their_scale():
    scale = ColorScale("Height", "mm", 0, 1)
    mesh = prepare_mesh(*box_mesh((0, 0, 0), (1, 1, 1)), values=np.arange(24), scale=scale)
    assert mesh.values.dtype == np.float32
    assert mesh.scale is scale


def test_a_large_mesh_is_prepared_quickly():
    vertices, faces = mug(200_000)
    seconds = []
    for _ in range(4):
        start = time.process_time()
        prepare_mesh(vertices, faces)
        seconds.append(time.process_time() - start)
    in_time(min(seconds), 0.06, "the preparation")
