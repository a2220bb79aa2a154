from __future__ import annotations

import time

import numpy as np
import pytest

from app.gui.views.scene.camera import Ray
from app.gui.views.scene.picking import BallTarget, FaceTarget
from app.gui.views.scene.shapes import box_mesh
from tests.awake import in_time
from tests.benchmarks.scene_speed import mug


def ray(origin, direction, spread=1e-3):
    unit = np.array(direction, dtype=float)
    return Ray(np.array(origin, dtype=float), unit / np.linalg.norm(unit), spread)


def test_the_nearest_face_is_met():
    target = FaceTarget(*box_mesh((-1, -1, -1), (1, 1, 1)))
    distance, face = target.hit(ray((0.2, 0.3, 5), (0, 0, -1)))
    assert distance == pytest.approx(4)
    assert (target.vertices_m[target.faces[face]][:, 2] == 1).all()


def test_faces_are_met_from_inside_too():
    target = FaceTarget(*box_mesh((-1, -1, -1), (1, 1, 1)))
    assert target.hit(ray((0, 0.1, 0.2), (1, 0, 0)))[0] == pytest.approx(1)


@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 0, 0)])
def test_nothing_is_met_beside_and_behind(direction):
    assert FaceTarget(*box_mesh((-1, -1, -1), (1, 1, 1))).hit(ray((0, 0, 5), direction)) is None


def test_faces_can_stand_for_something():
    vertices, faces = box_mesh((-1, -1, -1), (1, 1, 1))
    target = FaceTarget(vertices, faces, np.full(len(faces), 7))
    assert target.hit(ray((0, 0, 5), (0.01, 0.02, -1)))[1] == 7


def test_all_faces_are_looked_at():
    """The quick sorting out agrees with looking at each face by itself."""
    random = np.random.default_rng(0)
    vertices, faces = random.normal(size=(90, 3)), np.arange(90).reshape(-1, 3)
    n_hits = 0
    for direction in random.normal(size=(60, 3)):
        line = ray((0, 0, 0), direction)
        single = [FaceTarget(vertices, face[None]).hit(line) for face in faces]
        expected = min(((hit[0], k) for k, hit in enumerate(single) if hit), default=None)
        assert FaceTarget(vertices, faces).hit(line) == (expected and pytest.approx(expected))
        n_hits += expected is not None
    assert n_hits > 20


def test_the_nearest_ball_is_met_and_absent_ones_are_not():
    centers = np.array([[0, 0, 0], [0, 0, 1], [0, 0, np.nan], [3, 0, 0]], dtype=float)
    target = BallTarget(centers, 0.1)
    assert target.hit(ray((0.05, 0, 5), (0, 0, -1))) == (pytest.approx(3.9), 1)
    assert target.hit(ray((0.2, 0, 5), (0, 0, -1))) is None
    assert BallTarget(np.full((4, 3), np.nan), 0.1).hit(ray((0, 0, 5), (0, 0, -1))) is None
    assert BallTarget(np.empty((0, 3)), 0.1).hit(ray((0, 0, 5), (0, 0, -1))) is None


def test_points_are_met_some_pixels_aside_however_far_they_are():
    target = BallTarget(np.array([[0.004, 0, 0], [0.0, 0, -100]]))
    assert target.hit(ray((0, 0, 1), (0, 0, -1)))[1] == 0
    assert target.hit(ray((-0.1, 0, 1), (0, 0, -1)))[1] == 1


def test_picking_in_a_large_mesh_takes_no_longer_than_a_frame():
    vertices, faces = mug(200_000)
    target = FaceTarget(vertices.astype(np.float32), faces.astype(np.uint32))
    seconds = []
    for _ in range(5):
        start = time.process_time()
        hit = target.hit(ray((0.3, 0.01, 0.05), (-1, 0, 0)))
        seconds.append(time.process_time() - start)
    assert hit is not None
    in_time(min(seconds), 0.03)
