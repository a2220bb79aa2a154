"""What is damaged in a session is made anew, and nothing else; a linked stage can be replaced."""

import json

import pytest

from core.parameters import Parameters, apply_settings
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool
from hardware.simulation.objects import builtin_object
from tests.app.sessions import copied

QUICK = {
    "containability.n_max": 40,
    "containability.n_min": 20,
    "containability.rotation_s": 0.3,
    "capacity.n_fillings": 1,
    "holding.n_load": 4,
    "holding.tilt_step_rad": 0.25,
    "pouring.n_pour": 6,
    "pouring.n_packings": 1,
    "risk.n_tries": 0,
}
PARAMETERS = apply_settings(Parameters(), QUICK)
OMEGA = 9.75
"""Nothing that a drop can give."""


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(2) as workers:
        yield workers


@pytest.fixture(scope="module")
def finished(tmp_path_factory, pool):
    """A session's folder, to be copied: a small bowl, imagined."""
    from core.mesh_file import write_mesh

    folder = tmp_path_factory.mktemp("finished")
    write_mesh(folder / "bowl.ply", builtin_object("bowl"))
    with Session.create_or_open(folder / "session") as held:
        pipeline = Pipeline(held, PARAMETERS, pool, Reporter())
        pipeline.import_mesh(folder / "bowl.ply")
        pipeline.imagination()
    return folder / "session"


@pytest.fixture
def session(finished, tmp_path):
    with Session.open(copied(finished, tmp_path / "session")) as held:
        yield held


def made_anew(session, pool):
    """The stages that a new run makes."""
    before = {one.parent.name: one.stat().st_mtime_ns for one in session.path.glob("*/record.json")}
    result = Pipeline(session, PARAMETERS, pool, Reporter()).imagination()
    after = {one.parent.name: one.stat().st_mtime_ns for one in session.path.glob("*/record.json")}
    return result, {stage for stage, time_ns in after.items() if before.get(stage) != time_ns}


def change(path, **values):
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


@pytest.mark.parametrize(
    ("stage", "name", "values"),
    [
        ("judgement", "judgement.json", {"omega_threshold": "a word"}),
        ("judgement", "capacity.json", {"n_kept": None}),
        ("containability", "containability.json", {"omega": OMEGA}),
        ("amount", "amount.json", {"amount": 5}),
        ("pouring", "pours.json", {"theta_rad": []}),
    ],
)
def test_a_damaged_stage_is_made_anew(session, pool, stage, name, values):
    before = (session.path / stage / name).read_bytes()
    change(session.path / stage / name, **values)
    result, anew = made_anew(session, pool)
    assert stage in anew
    assert "collision" not in anew and "mesh" not in anew
    assert (session.path / stage / name).read_bytes() == before, "the same again"
    assert result.containability.omega != OMEGA


def test_a_stage_that_somebody_put_on_another_disk_is_replaced(session, pool, tmp_path):
    place, elsewhere = session.path / "containability", tmp_path / "elsewhere"
    place.rename(elsewhere)
    place.symlink_to(elsewhere)
    (elsewhere / "drop.npz").write_bytes(b"nothing")
    _, anew = made_anew(session, pool)
    assert "containability" in anew
    assert not place.is_symlink()
    assert (elsewhere / "drop.npz").read_bytes() == b"nothing", "what the link led to is left alone"
    assert not list(session.path.glob(".*.old"))
