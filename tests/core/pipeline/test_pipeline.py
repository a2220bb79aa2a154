"""Stale and fresh: a changed parameter makes the stages after it stale, and nothing else."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled
from core.parameters import Parameters, apply_settings
from core.pipeline.pipeline import Pipeline
from core.pipeline.running import parameters_of_tries
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.objects import builtin_object
from tests.app.quick_cell import quick_cell
from tests.app.sessions import copied

QUICK = {
    "reconstruction.voxel_m": 0.005,
    "containability.n_max": 64,
    "containability.n_min": 40,
    "containability.rotation_s": 0.3,
    "pouring.n_pour": 10,
    "containability.verdict": "omega",
    "risk.n_tries": 4,
    "evidence.films": False,
}
IMAGINED = ["containability", "judgement", "amount", "pouring", "risk"]
STAGES = ("scan", "reconstruction", "collision", *IMAGINED, "evidence")


class Recorder(Reporter):
    """Remembers which stages ran; optionally stops at one."""

    def __init__(self, stop_at=None):
        super().__init__()
        self.stages, self.news = [], []
        self._stop_at = stop_at

    def progress(self, stage, done, total):
        if stage not in self.stages:
            self.stages.append(stage)
        if stage == self._stop_at:
            self.cancel()

    def tell(self, news):
        self.news.append(news)


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(2) as workers:
        yield workers


@pytest.fixture(scope="module")
def scan():
    """With few views: what is tested is which stages run."""
    return simulate_scan(builtin_object("bowl"), 0, Reporter(), cell=quick_cell())


@pytest.fixture
def session(tmp_path, scan, pool):
    with Session.create_or_open(tmp_path / "session") as held:
        pipeline_of(held, pool).keep_scan(scan, {"object": "bowl"})
        yield held


@pytest.fixture(scope="module")
def imagined(tmp_path_factory, scan, pool):
    """A session's folder, to be copied, with everything imagined."""
    folder = tmp_path_factory.mktemp("imagined") / "session"
    with Session.create_or_open(folder) as held:
        pipeline_of(held, pool).keep_scan(scan, {"object": "bowl"})
        pipeline_of(held, pool).imagination()
    return folder


@pytest.fixture
def imagined_session(imagined, tmp_path):
    with Session.open(copied(imagined, tmp_path / "session")) as held:
        yield held


def pipeline_of(session, pool, settings=None, reporter=None):
    parameters = apply_settings(Parameters(), QUICK | (settings or {}))
    return Pipeline(session, parameters, pool, reporter or Recorder())


def created(session):
    return {
        stage: (session.path / stage / "record.json").stat().st_mtime_ns
        for stage in STAGES
        if (session.path / stage).exists()
    }


def renewed(before, after):
    return [stage for stage in STAGES if before.get(stage) != after.get(stage)]


@pytest.mark.system
def test_only_what_a_parameter_touches_runs_again(session, pool):
    path = pipeline_of(session, pool).report()
    written = path.read_text(encoding="utf-8")
    assert "Open container" in written
    assert "From behind" in written, "the model in its photographed colours"
    assert re.search(
        r"After the last view: the model \d+ s, the verdict \d+ s and the chosen pour \d+ s\.", written
    )
    first = created(session)
    assert list(first) == list(STAGES)

    pipeline_of(session, pool).report()
    assert renewed(first, created(session)) == []

    pipeline_of(session, pool, {"containability.omega_threshold": 0.01}).imagination()
    second = created(session)
    assert renewed(first, second) == ["judgement", "amount", "pouring"], "the same pours again"

    pipeline_of(session, pool, {"reconstruction.voxel_m": 0.006}).imagination()
    assert renewed(second, created(session)) == ["reconstruction", "collision", *IMAGINED]


@pytest.mark.parametrize(
    ("name", "value", "runs"),
    [
        ("pouring.gamma_0_rad", 0.7, ["pouring", "risk"]),
        ("risk.n_tries", 2, ["risk"]),
        ("pouring.n_pour", 8, ["amount", "pouring", "risk"]),
    ],
)
def test_a_pouring_parameter_runs_no_drop(name, value, runs, imagined_session, pool):
    session = imagined_session
    before = created(session)
    pipeline_of(session, pool, {name: value}).imagination()
    assert renewed(before, created(session)) == runs


def test_stages_side_by_side_make_what_each_makes_alone_and_only_what_is_stale(imagined_session, pool):
    """A reconstructed scan, of which the collision model is fresh already."""
    session, reporter, before = imagined_session, Recorder(), created(imagined_session)
    alone = pipeline_of(session, pool)
    expected = alone.quality(), alone.colors()
    digests = [session.record(name).inputs for name in ("quality", "colors")]
    for name in ("quality", "colors"):
        shutil.rmtree(session.path / name)

    pipeline_of(session, pool, reporter=reporter).side_by_side("quality", "colors", "collision")
    assert [session.record(name).inputs for name in ("quality", "colors")] == digests
    assert created(session) == before
    assert reporter.stages == ["colors"], "one run, called by what is finished last"
    assert [news.stage for news in reporter.news] == ["quality", "colors"]
    found = pipeline_of(session, pool)
    assert found.quality().verdict == expected[0].verdict
    assert np.array_equal(found.colors().rgb, expected[1].rgb)


def test_an_interrupted_run_continues_where_it_stopped(session, pool):
    with pytest.raises(Cancelled):
        pipeline_of(session, pool, reporter=Recorder(stop_at="pouring")).imagination()
    kept = created(session)
    assert list(kept) == ["scan", "reconstruction", "collision", "containability", "judgement", "amount"]
    again = Recorder()
    pipeline_of(session, pool, reporter=again).imagination()
    assert "reconstruction" not in again.stages
    assert renewed(kept, created(session)) == ["pouring", "risk"]


def test_a_loaded_imagination_is_the_one_that_was_run(session, pool):
    run = pipeline_of(session, pool).imagination()
    loaded = pipeline_of(session, pool).imagination()
    assert loaded.containability.omega == run.containability.omega
    assert (loaded.grid.n_in == run.grid.n_in).all()
    assert (loaded.choice.i, loaded.choice.j) == (run.choice.i, run.choice.j)
    assert loaded.choice.T_world_cup == pytest.approx(run.choice.T_world_cup)


@pytest.mark.parametrize(
    ("facts", "more_m"),
    [
        ({"camera_error_m": 0.004, "camera_error_rad": 0.01}, 0.004),
        ({}, 0.0),
        ({"camera_error_m": "far", "camera_error_rad": None}, 0.0),
        ({"camera_error_m": -1.0, "camera_error_rad": float("nan")}, 0.0),
    ],
)
def test_pours_are_tried_with_the_error_of_the_camera_that_scanned(facts, more_m, imagined_session, pool):
    pipeline = pipeline_of(imagined_session, pool)
    given = pipeline._given("risk")
    grid = given.result("pouring")
    usual = parameters_of_tries(given, grid).risk
    raised = parameters_of_tries(replace(given, scan_facts=facts), grid).risk
    assert raised.object_error_m == pytest.approx(np.hypot(usual.object_error_m, more_m))
    assert (raised.object_error_rad > usual.object_error_rad) == bool(more_m)


def test_a_record_tells_what_a_stage_was_made_from(imagined_session):
    session = imagined_session
    record = json.loads((session.path / "containability" / "record.json").read_text())
    assert record["inputs"] == {"collision": session.record("collision").digest}
    assert record["parameters"]["seed"] == 0
    assert {"python", "numpy", "pybullet", "poursight"} <= set(record["versions"])
