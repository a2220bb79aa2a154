from __future__ import annotations

import numpy as np
import pytest

from app.gui.views.scene.shapes import (
    arrow_mesh,
    box_edges,
    box_mesh,
    capsule_mesh,
    cylinder_mesh,
    merged,
)


def volume(shape):
    """Positive only if the faces are counter-clockwise from outside."""
    vertices, faces = shape
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


@pytest.mark.parametrize(
    ("shape", "expected", "tolerance"),
    [
        (box_mesh((1, 2, 3), (2, 4, 6)), 6, 1e-9),
        (cylinder_mesh(0.5, 2), np.pi / 2, 0.02),
        (cylinder_mesh(0.5, 2, top_radius_m=0.25), np.pi * 2 / 3 * (0.25 + 0.125 + 0.0625), 0.02),
        (capsule_mesh((1, 1, 1), (1, 3, 1), 0.5), np.pi * (0.5 + 0.5 / 3), 0.03),
        (capsule_mesh((1, 1, 1), (1, 1, 1), 0.5), np.pi * 0.5 / 3, 0.04),
    ],
    ids=["box", "cylinder", "frustum", "capsule", "sphere"],
)
def test_surfaces_enclose_what_they_should(shape, expected, tolerance):
    assert volume(shape) == pytest.approx(expected, rel=tolerance)


def test_a_capsule_reaches_its_radius_beyond_both_ends():
    vertices, _ = capsule_mesh((0, 0, 0), (1, 0, 0), 0.2)
    assert vertices.min(axis=0) == pytest.approx((-0.2, -0.2, -0.2))
    assert vertices.max(axis=0) == pytest.approx((1.2, 0.2, 0.2))


@pytest.mark.parametrize("end", [(0, 0, 1), (0, 0, -1), (0.3, -0.5, 0.2), (0, 1, 0)])
def test_an_arrow_goes_from_start_to_end(end):
    vertices, _ = arrow_mesh((0, 0, 0), end)
    along = vertices @ np.array(end) / np.dot(end, end)
    assert along.min() == pytest.approx(0, abs=1e-9)
    assert vertices[along.argmax()] == pytest.approx(end)


def test_a_box_has_twelve_edges():
    edges = box_edges((0, 0, 0), (1, 2, 3)).reshape(12, 2, 3)
    lengths = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    assert sorted(lengths) == [1] * 4 + [2] * 4 + [3] * 4


def test_merged_surfaces_keep_their_faces():
    one, other = box_mesh((0, 0, 0), (1, 1, 1)), box_mesh((5, 5, 5), (6, 6, 6))
    assert volume(merged([one, other])) == pytest.approx(2)
    assert [len(part) for part in merged([])] == [0, 0]
