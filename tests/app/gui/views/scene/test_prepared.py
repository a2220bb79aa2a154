from __future__ import annotations

import time

import numpy as np
import pytest

from app.gui.views.scene import ColorScale, prepare_mesh
from app.gui.views.scene.shapes import ball, box_mesh
from tests.benchmarks.scene_speed import mug


def test_normals_of_a_ball_point_outwards():
    vertices, faces = ball()
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
    vertices, faces = ball()
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
        start = time.perf_counter()
        prepare_mesh(vertices, faces)
        seconds.append(time.perf_counter() - start)
    assert min(seconds) < 0.06
