from __future__ import annotations

import numpy as np
import pytest
import trimesh

from core.mesh import TriangleMesh, surface_difference_m


def ball(radius_m, subdivisions=4):
    body = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_m)
    return TriangleMesh(np.asarray(body.vertices, dtype=float), np.asarray(body.faces, dtype=np.int64))


@pytest.mark.parametrize("grown_m", [0.002, -0.003])
def test_what_grew_lies_outside_and_what_shrank_inside(grown_m):
    difference_m = surface_difference_m(ball(0.05), ball(0.05 + grown_m, subdivisions=3))
    np.testing.assert_allclose(difference_m, grown_m, atol=1e-4)


def test_a_surface_does_not_differ_from_itself():
    mesh = ball(0.05)
    np.testing.assert_allclose(surface_difference_m(mesh, mesh), 0, atol=1e-6)


def test_what_moved_sideways_lies_outside_in_front_and_inside_behind():
    mesh = ball(0.05)
    difference_m = surface_difference_m(mesh, mesh.translated(np.array([0.004, 0, 0])))
    side = np.abs(mesh.vertices_m[:, 0]) > 0.045
    assert (np.sign(difference_m[side]) == np.sign(mesh.vertices_m[side, 0])).all()
    assert np.abs(difference_m).max() == pytest.approx(0.004, abs=1e-4)


def test_a_flat_sheet_has_its_centre_of_mass_in_its_middle():
    sheet = TriangleMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    with np.errstate(all="raise"):
        np.testing.assert_allclose(sheet.center_of_mass_m, [0.5, 0.5, 0])
