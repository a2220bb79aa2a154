"""Fitting in a host: each trial is told, the end is a preset's worth, and a cancel keeps the best."""

import queue
import subprocess
import sys

import pytest

from app.jobs.fit_work import FitDone, FitStepped, FitTask, FitWork
from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind, Finished, News
from core.evaluation.fitting.fitted import fitted_parameters
from core.evaluation.labels import read_labels
from core.parameters import Parameters, apply_settings, flatten
from core.ply import write_ply
from hardware.simulation.objects import builtin_object

QUICK = {
    "containability.verdict": "omega",
    "containability.n_max": 30,
    "containability.n_min": 10,
    "containability.rotation_s": 0.5,
    "solver.substeps": 2,
    "seed": 4,
}
FRICTION = "containability.contact.lateral_friction"


@pytest.fixture
def objects(tmp_path):
    for name in ("mug", "block"):
        write_ply(tmp_path / f"{name}.ply", builtin_object(name))
    (tmp_path / "labels.csv").write_text("id,label\nmug,container\nblock,non-container\n")
    return read_labels(tmp_path)


@pytest.fixture
def heard():
    return queue.Queue()


@pytest.fixture
def host(heard):
    host = Host(FitWork, "calibrates", heard.put)
    yield host
    host.close()


def test_the_windows_process_can_import_it():
    heavy = ("optuna", "numba", "open3d", "pybullet", "core.reconstruction")
    program = (
        "import sys, app.cli, app.jobs.fit_work; import core.evaluation.fitting.containability; "
        f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def task(objects, n_trials):
    parameters = apply_settings(Parameters(), QUICK)
    return FitTask(objects, "mesh", 1, parameters, "default", fitted_parameters([FRICTION]), n_trials)


def until_end(heard, timeout_s=60):
    messages = []
    while not messages or not isinstance(messages[-1], Finished | Failed):
        messages.append(heard.get(timeout=timeout_s))
    return messages


def test_trials_are_told_and_the_end_holds_what_was_found(host, heard, objects):
    host.start(FitWork.fit, task(objects, 3))
    messages = until_end(heard)
    steps = [message.payload.step for message in messages if isinstance(message, News)]
    assert [step.trial.number for step in steps] == [0, 1, 2]
    done = messages[-1].result
    assert isinstance(done, FitDone) and not done.is_cut_short
    assert done.provenance.seeds == (4,) and done.provenance.search["done"] == 3
    found = flatten(done.parameters)
    assert found[FRICTION] == steps[-1].best.values[FRICTION]
    assert found["containability.omega_threshold"] == steps[-1].best.score.threshold
    assert set(done.named) == {FRICTION, "containability.omega_threshold"}


def test_a_cancelled_fit_ends_with_the_best(host, heard, objects):
    host.start(FitWork.fit, task(objects, 1000))
    while not isinstance(message := heard.get(timeout=60), News):
        pass
    assert isinstance(message.payload, FitStepped)
    host.cancel()
    end = until_end(heard)[-1]
    assert isinstance(end, Finished), end
    assert end.result.is_cut_short
    assert end.result.provenance.search["done"] < 1000


def test_a_mesh_that_is_none_is_told_of(host, heard, objects):
    objects[0].mesh.write_text("no mesh at all\n")
    host.start(FitWork.fit, task(objects, 3))
    messages = until_end(heard)
    assert isinstance(messages[-1], Failed) and messages[-1].kind is FailureKind.EXPLAINED
    assert "without a single container" in messages[-1].sentence
