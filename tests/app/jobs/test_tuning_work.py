"""Judging labelled objects in a host: verdicts come one by one, and a bad object is a row, not the end."""

import psutil
import pytest

from app.jobs.messages import Failed, FailureKind, Progressed
from app.jobs.tuning_work import JudgingTask, TuningWork, VerdictReached, verdict_file
from core.evaluation.labels import read_labels
from core.evaluation.verdicts import ObjectVerdict
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings
from hardware.simulation.objects import builtin_object
from tests.app.jobs.hosts import ListenedHost
from tests.awake import within

pytestmark = pytest.mark.system

QUICK = {
    "containability.verdict": "omega",
    "containability.n_max": 64,
    "containability.n_min": 20,
    "solver.substeps": 4,
}


@pytest.fixture
def folder(tmp_path):
    """A mug, a block, and a mesh that is none."""
    (tmp_path / "meshes").mkdir()
    for name in ("mug", "block"):
        write_ply(tmp_path / "meshes" / f"{name}.ply", builtin_object(name))
    (tmp_path / "meshes" / "junk.obj").write_text("no mesh at all\n")
    (tmp_path / "labels.csv").write_text("id,label\njunk,container\nmug,container\nblock,non-container\n")
    return tmp_path


@pytest.fixture
def judging():
    judging = ListenedHost(TuningWork, "tunes")
    yield judging
    judging.host.close()


def test_all_are_judged_and_the_bad_one_says_why(judging, folder, tmp_path):
    results = tmp_path / "results"
    parameters = apply_settings(Parameters(), QUICK)
    assert judging.do(TuningWork.judge, JudgingTask(read_labels(folder), parameters, results)) == 3
    assert all(isinstance(event, VerdictReached) and event.folder == results for event in judging.events)
    verdicts = {event.verdict.name: event.verdict for event in judging.events}
    assert set(verdicts) == {"mug", "block", "junk"}
    assert verdicts["mug"].omega > 0.1
    assert verdicts["block"].omega == 0
    assert verdicts["junk"].omega is None and "junk.obj" in verdicts["junk"].problem
    assert ObjectVerdict.load(verdict_file(results, "mug")) == verdicts["mug"]
    assert any(isinstance(message, Progressed) and message.total == 3 for message in judging.messages)


def test_a_killed_worker_costs_no_other_object(judging, folder, tmp_path):
    parameters = apply_settings(Parameters(), QUICK)
    task = JudgingTask(read_labels(folder), parameters, tmp_path / "results")
    judging.host.start(TuningWork.judge, task)
    judging.wait_for(VerdictReached)
    workers = [
        child
        for child in psutil.Process(judging.host.pid).children()
        if "spawn_main" in " ".join(child.cmdline())
    ]
    workers[0].kill()
    assert judging.wait() == 3
    verdicts = [ObjectVerdict.load(path) for path in (tmp_path / "results").glob("*.json")]
    assert {verdict.name for verdict in verdicts if verdict.omega is not None} == {"mug", "block"}


def test_a_cancelled_run_keeps_what_was_finished(judging, folder, tmp_path):
    results = tmp_path / "results"
    slow = apply_settings(Parameters(), QUICK | {"containability.n_max": 1000, "containability.n_min": 1000})
    judging.host.start(TuningWork.judge, JudgingTask(read_labels(folder), slow, results))
    assert judging.wait_for(VerdictReached).verdict.name == "junk"
    with within(2):
        judging.host.cancel()
        end = judging.end()
    assert isinstance(end, Failed) and end.kind is FailureKind.CANCELLED
    assert [path.name for path in results.glob("*.json")] == ["junk.json"]
