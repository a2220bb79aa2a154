"""The authors' scan: their mesh with their parameters, a closed tray with ours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from core.parameters import load_preset
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.scan import Scan, read_scan


@pytest.fixture(scope="module")
def tray(shared_data: Path) -> Scan:
    return read_scan(shared_data / "real_scan" / "amazon_tray", Reporter())


def test_authors_preset_gives_the_authors_mesh(tray, shared_data, listener):
    path = shared_data / "real_scan" / "amazon_tray" / "reference" / "authors_mesh.obj"
    theirs = trimesh.load(path, process=False)
    ours = reconstruct(tray, load_preset("authors").reconstruction, listener).mesh
    assert np.array_equal(ours.faces, theirs.faces)
    assert np.linalg.norm(ours.vertices_m - theirs.vertices, axis=1).max() < 1e-5
    assert listener.warnings == []


def test_default_preset_gives_a_closed_tray_of_the_true_height(tray, listener):
    result = reconstruct(tray, load_preset("default").reconstruction, listener)
    body = trimesh.Trimesh(result.mesh.vertices_m, result.mesh.faces, process=False)
    assert body.is_watertight and body.is_winding_consistent and body.body_count == 1
    assert 0.022 < body.extents[2] < 0.031
    assert body.extents[:2] == pytest.approx([0.254, 0.098], abs=0.006)
    # Open at the top: the floor in the middle lies well below the rim, and is there.
    middle = np.linalg.norm(body.vertices[:, :2] - [-0.1, -0.29], axis=1) < 0.02
    floor_m = body.vertices[middle & (body.vertex_normals[:, 2] > 0.5), 2]
    assert floor_m.max() < body.bounds[1, 2] - 0.01
    assert floor_m.min() > body.bounds[0, 2] + 0.004
    assert result.refinement.residual_after_m < 0.4 * result.refinement.residual_before_m
    assert result.refinement.table_sd_after_m < result.refinement.table_sd_before_m


def test_the_table_tells_the_pose_error(tray, listener):
    health = reconstruct(tray, load_preset("default").reconstruction, listener).pose_health
    assert health.mean_height_m == pytest.approx(0.0186, abs=0.001)
    assert health.sd_height_m == pytest.approx(0.0030, abs=0.0004)
    tilts_deg = np.rad2deg([view.tilt_rad for view in health.views])
    assert tilts_deg.min() == pytest.approx(0.2, abs=0.2)
    assert tilts_deg.max() == pytest.approx(3.2, abs=0.2)
