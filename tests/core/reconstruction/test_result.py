from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from core.errors import SessionError
from core.geometry import look_at
from core.mesh import TriangleMesh
from core.reconstruction.pose_health import PoseHealth, ViewHealth
from core.reconstruction.result import Reconstruction, Refinement, ViewCorrection


@pytest.fixture
def result() -> Reconstruction:
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    mesh = TriangleMesh(np.asarray(box.vertices) / 3, np.asarray(box.faces))
    health = PoseHealth((ViewHealth("frame-000001", 0.1 / 3, 0.01), ViewHealth("frame-000002", None, None)))
    pose = look_at([0.1, 0.2, 1 / 3], [0.0, 0.0, 0.0])
    views = (ViewCorrection("frame-000001", 1e-3 / 3, 0.01, 0.002, None, pose),)
    return Reconstruction(mesh, 0.0815, 0.02, health, Refinement(views, 0.002, 0.0005, None, 1e-3 / 7, 3e-4))


def test_it_loads_what_it_saved(result, tmp_path):
    result.save(tmp_path)
    loaded = Reconstruction.load(tmp_path)
    assert np.array_equal(loaded.mesh.vertices_m, result.mesh.vertices_m)
    assert np.array_equal(loaded.mesh.faces, result.mesh.faces)
    assert loaded.pose_health == result.pose_health
    assert (loaded.platform_height_m, loaded.truncation_m) == (0.0815, 0.02)
    for before, after in zip(result.refinement.views, loaded.refinement.views, strict=True):
        assert np.array_equal(after.T_base_camera, before.T_base_camera)
        assert replace(after, T_base_camera=None) == replace(before, T_base_camera=None)
    assert replace(loaded.refinement, views=()) == replace(result.refinement, views=())


def test_poses_as_recorded_are_kept_as_no_refinement(result, tmp_path):
    replace(result, refinement=None).save(tmp_path)
    assert Reconstruction.load(tmp_path).refinement is None


def test_the_surface_errs_by_some_view_errors(result):
    assert result.surface_error_m == pytest.approx(3 * 3e-4)
    assert replace(result, refinement=None).surface_error_m == 0


def test_other_programs_read_the_mesh(result, tmp_path):
    result.save(tmp_path)
    read = trimesh.load(tmp_path / "mesh.ply", process=False)
    assert np.array_equal(read.vertices, result.mesh.vertices_m)
    assert read.volume == pytest.approx(result.mesh.volume_m3)


@pytest.mark.parametrize("name", ["mesh.ply", "result.json"])
@pytest.mark.parametrize("damage", ["missing", "short", "other"])
def test_a_damaged_file_is_named(result, tmp_path, name, damage):
    result.save(tmp_path)
    path = tmp_path / name
    if damage == "missing":
        path.unlink()
    elif damage == "short":
        path.write_bytes(path.read_bytes()[:-20])
    else:
        path.write_text("{}")
    with pytest.raises(SessionError, match=name.replace(".", r"\.")):
        Reconstruction.load(tmp_path)
