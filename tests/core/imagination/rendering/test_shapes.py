from __future__ import annotations

import numpy as np
import pytest

from core.errors import StageError
from core.imagination.rendering.shapes import candy_mesh, cup_surface, write_obj
from core.mesh import TriangleMesh
from core.parameters.bodies import CupParameters, ParticleParameters


def read_obj(path):
    rows = [line.split() for line in path.read_text().splitlines()]
    vertices = np.array([row[1:] for row in rows if row[0] == "v"], dtype=float)
    normals = np.array([row[1:] for row in rows if row[0] == "vn"], dtype=float)
    corners = np.array([[pair.split("//") for pair in row[1:]] for row in rows if row[0] == "f"], dtype=int)
    return vertices, normals, corners - 1


def is_closed(mesh: TriangleMesh) -> bool:
    edges = np.vstack([mesh.faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    return sorted(map(tuple, edges.tolist())) == sorted(map(tuple, edges[:, ::-1].tolist()))


def test_a_box_keeps_its_edges_and_is_scaled(story, tmp_path):
    write_obj(tmp_path / "box.obj", story.surface, 10.0)
    vertices, normals, corners = read_obj(tmp_path / "box.obj")
    np.testing.assert_allclose(vertices, story.surface.vertices_m * 10, atol=1e-5)
    assert len(corners) == 12
    shaded = normals[corners[:, :, 1]]
    assert np.abs(shaded).max(axis=2).min() > 0.85  # shaded by face, not rounded off


def test_a_round_surface_is_shaded_smoothly(tmp_path):
    mesh = candy_mesh(ParticleParameters(shape="sphere", diameter_m=0.02))
    write_obj(tmp_path / "sphere.obj", mesh, 1.0)
    vertices, normals, corners = read_obj(tmp_path / "sphere.obj")
    outwards = vertices[corners[:, :, 0]]
    outwards /= np.linalg.norm(outwards, axis=2, keepdims=True)
    assert (np.einsum("fki,fki->fk", normals[corners[:, :, 1]], outwards) > 0.97).all()


def test_an_open_surface_is_seen_from_both_sides(story, tmp_path):
    write_obj(tmp_path / "open.obj", TriangleMesh(story.surface.vertices_m, story.surface.faces[:6]), 1.0)
    assert len(read_obj(tmp_path / "open.obj")[2]) == 12


@pytest.mark.parametrize("shape", ["cylinder", "ellipsoid", "sphere"])
def test_a_candy_is_closed_and_has_its_size(shape):
    particle = ParticleParameters(shape=shape, diameter_m=0.013, height_m=0.007)
    mesh = candy_mesh(particle)
    assert is_closed(mesh)
    assert mesh.volume_m3 > 0
    height = 0.013 if shape == "sphere" else 0.007
    np.testing.assert_allclose(mesh.extents_m, [0.013, 0.013, height], rtol=0.06)


def test_the_cup_is_closed_and_has_its_size():
    cup = CupParameters()
    mesh = cup_surface(cup)
    assert is_closed(mesh)
    np.testing.assert_allclose(mesh.aabb_max_m, [cup.mouth_radius_m, cup.mouth_radius_m, cup.length_m])
    solid_m3 = np.pi * cup.mouth_radius_m**2 * cup.length_m
    assert 0.05 * solid_m3 < mesh.volume_m3 < 0.2 * solid_m3  # hollow


def test_an_unknown_shape_is_an_error_and_no_other_shape():
    particle = ParticleParameters().model_copy(update={"shape": "cube"})
    with pytest.raises(StageError, match="particle shape 'cube'"):
        candy_mesh(particle)
