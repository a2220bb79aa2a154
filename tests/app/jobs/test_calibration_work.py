"""Judging labelled objects in a host: verdicts come one by one, and a bad object is a row, not the end."""

import queue
import time

import psutil
import pytest

from app.jobs.calibration_work import CalibrationTask, CalibrationWork, VerdictReached, verdict_file
from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind, Finished, News, Progressed
from core.evaluation.labels import read_labels
from core.evaluation.verdicts import ObjectVerdict
from core.parameters import Parameters, apply_settings
from core.ply import write_ply
from hardware.simulation.objects import builtin_object

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
def heard():
    return queue.Queue()


@pytest.fixture
def host(heard):
    host = Host(CalibrationWork, "calibrates", heard.put)
    yield host
    host.close()


def until_end(heard, timeout_s=60):
    messages = []
    while not messages or not isinstance(messages[-1], Finished | Failed):
        messages.append(heard.get(timeout=timeout_s))
    return messages


def test_all_are_judged_and_the_bad_one_says_why(host, heard, folder, tmp_path):
    results = tmp_path / "results"
    parameters = apply_settings(Parameters(), QUICK)
    host.start(CalibrationWork.judge, CalibrationTask(read_labels(folder), parameters, results))
    messages = until_end(heard)
    assert messages[-1] == Finished(3)
    told = [message.payload for message in messages if isinstance(message, News)]
    assert {news.verdict.name for news in told} == {"mug", "block", "junk"}
    assert all(isinstance(news, VerdictReached) and news.folder == results for news in told)
    verdicts = {news.verdict.name: news.verdict for news in told}
    assert verdicts["mug"].omega > 0.1
    assert verdicts["block"].omega == 0
    assert verdicts["junk"].omega is None and "junk.obj" in verdicts["junk"].problem
    assert ObjectVerdict.load(verdict_file(results, "mug")) == verdicts["mug"]
    assert any(isinstance(message, Progressed) and message.total == 3 for message in messages)


def test_a_killed_worker_costs_no_other_object(host, heard, folder, tmp_path):
    parameters = apply_settings(Parameters(), QUICK)
    host.start(CalibrationWork.judge, CalibrationTask(read_labels(folder), parameters, tmp_path / "results"))
    while not isinstance(heard.get(timeout=60), News):
        pass
    workers = [
        child for child in psutil.Process(host.pid).children() if "spawn_main" in " ".join(child.cmdline())
    ]
    workers[0].kill()
    messages = until_end(heard)
    assert messages[-1] == Finished(3)
    verdicts = [ObjectVerdict.load(path) for path in (tmp_path / "results").glob("*.json")]
    assert {verdict.name for verdict in verdicts if verdict.omega is not None} == {"mug", "block"}


def test_a_cancelled_run_keeps_what_was_finished(host, heard, folder, tmp_path):
    results = tmp_path / "results"
    slow = apply_settings(Parameters(), QUICK | {"containability.n_max": 1000, "containability.n_min": 1000})
    host.start(CalibrationWork.judge, CalibrationTask(read_labels(folder), slow, results))
    first = None
    while not isinstance(first, News):
        first = heard.get(timeout=60)
    assert first.payload.verdict.name == "junk"
    began_s = time.monotonic()
    host.cancel()
    end = until_end(heard)[-1]
    assert isinstance(end, Failed) and end.kind is FailureKind.CANCELLED
    assert time.monotonic() - began_s < 2
    assert [path.name for path in results.glob("*.json")] == ["junk.json"]
