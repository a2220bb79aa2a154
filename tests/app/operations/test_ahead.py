"""While an arm scans, the cup's runs are made and kept; whoever stops the scan does not wait for them."""

from __future__ import annotations

import pytest

from app.jobs.session_work import SessionWork
from app.library.places import cup_runs_folder
from app.operations.ahead import computing_ahead
from core.errors import Cancelled
from core.imagination.kept_runs import KeptRuns
from core.imagination.risk.ahead import set_ups_ahead
from core.parameters import Parameters, apply_settings
from core.workers import WorkerPool
from tests.app.jobs.hosts import ListenedHost
from tests.awake import within
from tests.patience import wait_until

FEW = apply_settings(Parameters(), {"pouring.n_pour": 4, "risk.n_tries": 3})
ENDLESS = apply_settings(Parameters(), {"pouring.n_packings": 40})


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return KeptRuns(cup_runs_folder())


def test_a_scans_time_is_used(kept):
    with WorkerPool(2) as pool, computing_ahead(FEW, pool):
        wait_until(lambda: kept.size()[0] == len(set_ups_ahead(FEW)))


def test_a_cup_that_cannot_hold_the_candies_is_no_error_of_the_scan(kept):
    too_many = apply_settings(FEW, {"pouring.n_pour": 900, "pouring.amount": "number"})
    with WorkerPool(1) as pool, computing_ahead(too_many, pool):
        pass
    assert kept.size()[0] == 0


@pytest.mark.system
def test_who_stops_the_scan_does_not_wait(kept):
    with WorkerPool(2) as pool, pytest.raises(Cancelled), within(2.0), computing_ahead(ENDLESS, pool):
        wait_until(lambda: kept.size()[0] >= 2)
        raise Cancelled("somebody stopped it")


@pytest.mark.system
def test_the_process_that_imagines_uses_its_idle_time_and_a_job_comes_first(kept, tmp_path):
    listened = ListenedHost(SessionWork, "imagines")
    try:
        listened.host.open()
        listened.host.order(SessionWork.compute_ahead, ENDLESS)
        wait_until(lambda: kept.size()[0] >= 2)
        listened.do(SessionWork.import_mesh, None, tmp_path / "missing")
        assert kept.size()[0] < len(set_ups_ahead(ENDLESS))
    finally:
        listened.host.close()
