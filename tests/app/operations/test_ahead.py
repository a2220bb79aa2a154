"""While an arm scans, the cup's runs are made and kept; whoever stops the scan does not wait for them."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from app.jobs.session_work import SessionWork
from app.library.places import cup_runs_folder
from app.operations.ahead import ViewsAhead, computing_ahead
from app.operations.session import SessionTask
from core.errors import Cancelled
from core.imagination.kept_runs import KeptRuns
from core.imagination.risk.ahead import set_ups_ahead
from core.parameters import Parameters, apply_settings
from core.pipeline.jobs import reconstruction_job
from core.pipeline.rehearsal import small_scan
from core.progress import Reporter
from core.reconstruction import pose_health
from core.scan import decoded, write_camera, write_frame
from core.workers import Task, WorkerPool
from tests.app.jobs.hosts import ListenedHost
from tests.awake import within
from tests.patience import wait_until

FEW = apply_settings(Parameters(), {"pouring.n_pour": 4, "risk.n_tries": 3})
ENDLESS = apply_settings(Parameters(), {"pouring.n_packings": 40})


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return KeptRuns(cup_runs_folder())


def test_a_scans_time_is_used(kept, tmp_path):
    with WorkerPool(2) as pool, computing_ahead(FEW, pool, tmp_path):
        wait_until(lambda: kept.size()[0] == len(set_ups_ahead(FEW)))


def test_a_cup_that_cannot_hold_the_candies_is_no_error_of_the_scan(kept, tmp_path):
    too_many = apply_settings(FEW, {"pouring.n_pour": 900, "pouring.amount": "number"})
    with WorkerPool(1) as pool, computing_ahead(too_many, pool, tmp_path):
        pass
    assert kept.size()[0] == 0


def test_views_are_read_before_the_last_one_and_the_surface_is_the_same(tmp_path):
    scan, parameters = small_scan(), Parameters()
    write_camera(scan.intrinsics, scan.platform_height_m, tmp_path, scan.crop_box)
    with WorkerPool(1) as pool:
        views = ViewsAhead(tmp_path, parameters, pool)
        for n, frame in enumerate(scan.frames, 1):
            write_frame(frame, tmp_path)
            views.read(Reporter())
            assert pool.run([Task(n_views_known, ())], "known", Reporter()) == [(n, n)]
        job = Task(reconstruction_job, (tmp_path, parameters.reconstruction))
        [(known, warnings)] = pool.run([job], "reconstruction", Reporter())
    with WorkerPool(1) as pool:
        [(fresh, fresh_warnings)] = pool.run([job], "reconstruction", Reporter())
    np.testing.assert_array_equal(known.mesh.vertices_m, fresh.mesh.vertices_m)
    np.testing.assert_array_equal(known.mesh.faces, fresh.mesh.faces)
    assert known.pose_health == fresh.pose_health
    assert warnings == fresh_warnings


def n_views_known():
    """In a worker: of how many views it knows the images and the table."""
    return len(decoded._kept), len(pose_health._tables)


@pytest.mark.system
def test_who_stops_the_scan_does_not_wait(kept, tmp_path):
    ahead = partial(computing_ahead, ENDLESS, unfinished=tmp_path)
    with WorkerPool(2) as pool, pytest.raises(Cancelled), within(2.0), ahead(pool):
        wait_until(lambda: kept.size()[0] >= 2)
        raise Cancelled("somebody stopped it")


@pytest.mark.system
def test_the_process_that_imagines_uses_its_idle_time_and_a_job_comes_first(kept, tmp_path):
    listened = ListenedHost(SessionWork, "imagines")
    try:
        listened.host.open()
        listened.host.order(SessionWork.compute_ahead, SessionTask(tmp_path, ENDLESS, "default"))
        wait_until(lambda: kept.size()[0] >= 2)
        listened.do(SessionWork.import_mesh, None, tmp_path / "missing")
        assert kept.size()[0] < len(set_ups_ahead(ENDLESS))
    finally:
        listened.host.close()
