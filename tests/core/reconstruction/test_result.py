from __future__ import annotations

import numpy as np
import pytest
import trimesh

from core.errors import SessionError
from core.mesh import TriangleMesh
from core.reconstruction import PoseHealth, Reconstruction, ViewHealth


@pytest.fixture
def result() -> Reconstruction:
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    mesh = TriangleMesh(np.asarray(box.vertices) / 3, np.asarray(box.faces))
    health = PoseHealth((ViewHealth("frame-000001", 0.1 / 3, 0.01), ViewHealth("frame-000002", None, None)))
    return Reconstruction(mesh, 0.0815, 0.02, health)


def test_it_loads_what_it_saved(result, tmp_path):
    result.save(tmp_path)
    loaded = Reconstruction.load(tmp_path)
    assert np.array_equal(loaded.mesh.vertices_m, result.mesh.vertices_m)
    assert np.array_equal(loaded.mesh.faces, result.mesh.faces)
    assert loaded.pose_health == result.pose_health
    assert (loaded.platform_height_m, loaded.truncation_m) == (0.0815, 0.02)


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
