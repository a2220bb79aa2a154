"""A session of an object that the fixed views do not suit."""

from __future__ import annotations

import numpy as np
import pytest

from app.operations.scanning import scan_object
from app.operations.session import SessionTask, working_on
from core.mesh_file import write_mesh
from core.parameters import Parameters
from core.progress import Reporter
from core.scan import read_scan
from core.workers import WorkerPool
from hardware.cell import read_cell
from hardware.cell.scene import object_space
from hardware.scanning.store import read_plan
from hardware.simulation.placing import place_on_platform, transform_mesh
from tests.large_objects import INSIDE_M, SEEN_M, cylinder, floor_heights_m

CELL = read_cell()


@pytest.mark.system
def test_a_tall_cylinder_is_scanned_in_a_session_with_the_crop_box_that_was_found(tmp_path):
    mesh, session = cylinder(0.075, 0.40), tmp_path / "session"
    write_mesh(tmp_path / "tall.ply", mesh)
    with (
        WorkerPool() as pool,
        working_on(SessionTask(session, Parameters(), ""), pool, Reporter()) as pipeline,
    ):
        scan_object(pipeline, CELL, str(tmp_path / "tall.ply"))
        surface = pipeline.reconstruction().mesh
    plan = read_plan(session / "scan")
    assert plan is not None
    assert plan.crop_box.max_m[2] > 0.48 > CELL.place.crop_max_m[2]
    assert read_scan(session / "scan", Reporter()).crop_box == plan.crop_box
    pose = place_on_platform(mesh, Parameters().seed, CELL.place, object_space(CELL))
    true = transform_mesh(mesh, pose)
    np.testing.assert_allclose(surface.aabb_min_m, true.aabb_min_m, atol=SEEN_M)
    np.testing.assert_allclose(surface.aabb_max_m, true.aabb_max_m, atol=SEEN_M)
    assert floor_heights_m(surface, true) == pytest.approx(floor_heights_m(true, true), abs=INSIDE_M)
