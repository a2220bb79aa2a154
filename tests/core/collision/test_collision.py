import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pytest import CaptureFixture
from scipy.spatial import ConvexHull

from core.collision import CollisionModel, build_collision_model, from_parts, read_collision_model
from core.collision.simplification import simplify
from core.errors import SessionError
from core.mesh import SurfaceDistance, TriangleMesh
from core.mesh_file import read_mesh
from core.mesh_topology import is_convex, join, topology
from core.parameters.reconstruction import CollisionParameters
from core.progress import Reporter
from tests.core.imagination.capacity.conftest import open_box


class Listener(Reporter):
    def __init__(self) -> None:
        super().__init__()
        self.sentences: list[str] = []

    def warn(self, sentence: str) -> None:
        self.sentences.append(sentence)


def as_mesh(made: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))


@pytest.fixture(scope="module")
def cup() -> TriangleMesh:
    profile = [(0, 0), (0.04, 0), (0.04, 0.09), (0.035, 0.09), (0.035, 0.006), (0, 0.006)]
    return as_mesh(trimesh.creation.revolve(profile, sections=48))


def equal(a: CollisionModel, b: CollisionModel) -> bool:
    pairs = zip((*a.parts, a.surface), (*b.parts, b.surface), strict=True)
    return a.method == b.method and all(
        np.array_equal(p.vertices_m, q.vertices_m) and np.array_equal(p.faces, q.faces) for p, q in pairs
    )


def covers(model: CollisionModel, point_m: list[float]) -> bool:
    """Whether a point lies in one of the convex parts."""
    hulls = [ConvexHull(part.vertices_m) for part in model.parts if part.volume_m3 > 1e-9]
    return any((hull.equations @ [*point_m, 1.0] <= 0).all() for hull in hulls)


def test_exact_is_the_surface_itself(cup: TriangleMesh) -> None:
    model = build_collision_model(cup, CollisionParameters(), Reporter())
    assert model.method == "exact"
    assert not model.is_convex
    assert model.parts == (model.surface,)
    np.testing.assert_array_equal(model.surface.vertices_m, cup.vertices_m)
    np.testing.assert_array_equal(model.aabb_max_m, cup.aabb_max_m)
    np.testing.assert_array_equal(model.aabb_min_m, cup.aabb_min_m)


def test_simplified_stays_closed_and_in_shape() -> None:
    ball = as_mesh(trimesh.creation.icosphere(subdivisions=5, radius=0.05))
    coarse = simplify(ball, 3000)
    assert len(coarse.faces) <= 3000
    assert topology(coarse).is_closed
    assert coarse.volume_m3 == pytest.approx(ball.volume_m3, rel=0.01)


def test_huge_meshes_become_as_small() -> None:
    ball = as_mesh(trimesh.creation.icosphere(subdivisions=7, radius=0.05))
    assert len(ball.faces) > 300_000
    coarse = simplify(ball, 5000)
    assert len(coarse.faces) <= 5000
    assert coarse.volume_m3 == pytest.approx(ball.volume_m3, rel=0.01)


def test_faces_that_share_no_vertices_keep_the_shape() -> None:
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.05)
    soup = TriangleMesh(
        np.array(ball.triangles).reshape(-1, 3), np.arange(3 * len(ball.faces)).reshape(-1, 3)
    )
    coarse = simplify(soup, 3000)
    assert SurfaceDistance(coarse).of_m(soup.vertices_m).mean() < 0.0005


def test_a_mesh_that_would_be_ruined_keeps_more_faces(shared_data: Path) -> None:
    path = shared_data / "objects/meshes/cdb_teapot.obj"
    teapot = read_mesh(path, Reporter())
    for wanted in (200, 2000):
        coarse = simplify(teapot, wanted)
        assert wanted < len(coarse.faces) < len(teapot.faces)
        np.testing.assert_allclose(coarse.extents_m, teapot.extents_m, atol=0.002)


@pytest.mark.parametrize("wanted", [1300, 2600])
def test_thin_walls_stay_where_the_average_would_let_them_go(wanted: int) -> None:
    """With 2600 faces it is 0.49 mm off on average, and 7 mm where one vertex in a hundred is."""
    box = open_box((0.2, 0.15, 0.15), 0.002)
    fine = trimesh.Trimesh(*trimesh.remesh.subdivide_to_size(box.vertices_m, box.faces, 0.005))
    fine.merge_vertices()
    noise_m = np.random.default_rng(0).normal(0, 0.0003, fine.vertices.shape)
    rough = TriangleMesh(np.array(fine.vertices) + noise_m, np.array(fine.faces, dtype=np.int64))
    coarse = simplify(rough, wanted)
    distances_m = SurfaceDistance(coarse).of_m(rough.vertices_m)
    assert np.percentile(distances_m, 99) < 0.0012
    assert len(coarse.faces) <= 4 * wanted
    assert topology(coarse).n_open == 0


@pytest.mark.parametrize("method", ["vhacd", "coacd"])
def test_decomposition(cup: TriangleMesh, method: str, tmp_path: Path) -> None:
    parameters = CollisionParameters.model_validate({"method": method})
    model = build_collision_model(cup, parameters, Reporter())
    assert model.method == method
    assert model.is_convex
    assert len(model.parts) > 8
    solid = [part for part in model.parts if part.volume_m3 > 1e-9]
    assert all(map(is_convex, solid))
    # Overlaps of the parts count twice, and each is larger than what it covers.
    assert cup.volume_m3 < join(model.parts).volume_m3 < 3 * cup.volume_m3
    assert not covers(model, [0, 0, 0.05])
    assert covers(model, [0.005, 0.002, 0.003])
    np.testing.assert_allclose(join(model.parts).extents_m, cup.extents_m, atol=0.003)
    assert equal(model, build_collision_model(cup, parameters, Reporter()))
    model.save(tmp_path)
    assert equal(model, CollisionModel.load(tmp_path))


def test_an_open_mesh_is_warned_about(cup: TriangleMesh) -> None:
    lidless = TriangleMesh(cup.vertices_m, cup.faces[1:])
    listener = Listener()
    build_collision_model(lidless, CollisionParameters(method="vhacd"), listener)
    assert len(listener.sentences) == 1
    assert "3 open edges" in listener.sentences[0]


@pytest.mark.parametrize("method", ["vhacd", "coacd"])
def test_libraries_in_c_stay_silent(method: str, capfd: CaptureFixture[str]) -> None:
    box = as_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    build_collision_model(box, CollisionParameters.model_validate({"method": method}), Reporter())
    os.write(1, b"still open")
    assert capfd.readouterr().out == "still open"


def test_given_convex_parts_are_used_as_they_are(shared_data: Path) -> None:
    path = shared_data / "real_scan/amazon_tray/reference/authors_vhacd.obj"
    model = read_collision_model(path, CollisionParameters(), Reporter())
    assert model.method == "given"
    assert model.is_convex
    assert len(model.parts) == 16
    np.testing.assert_array_equal(model.aabb_min_m, join(model.parts).aabb_min_m)


def test_a_single_mesh_file_is_built(cup: TriangleMesh, tmp_path: Path) -> None:
    trimesh.Trimesh(cup.vertices_m, cup.faces).export(tmp_path / "cup.stl")
    model = read_collision_model(tmp_path / "cup.stl", CollisionParameters(), Reporter())
    assert model.method == "exact"
    assert topology(model.surface).is_closed


def test_exact_and_given_come_back_exactly(cup: TriangleMesh, tmp_path: Path) -> None:
    for model in (
        build_collision_model(cup, CollisionParameters(), Reporter()),
        from_parts((as_mesh(trimesh.creation.box((0.1, 0.2, 0.3))), cup)),
    ):
        model.save(tmp_path)
        assert equal(model, CollisionModel.load(tmp_path))


def test_a_damaged_model_is_a_sentence(cup: TriangleMesh, tmp_path: Path) -> None:
    with pytest.raises(SessionError, match=r"collision\.json"):
        CollisionModel.load(tmp_path)
    build_collision_model(cup, CollisionParameters(), Reporter()).save(tmp_path)
    np.savez_compressed(tmp_path / "collision.npz", part_faces=np.zeros((1, 3)))
    with pytest.raises(SessionError, match="damaged"):
        CollisionModel.load(tmp_path)


def test_how_far_a_scans_surface_errs_is_kept(cup: TriangleMesh, tmp_path: Path) -> None:
    replace(CollisionModel.exact(cup), surface_error_m=0.0011).save(tmp_path)
    assert CollisionModel.load(tmp_path).surface_error_m == 0.0011
