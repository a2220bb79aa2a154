"""Fitting in a host: each trial is reported, the end is a preset's worth, and a cancel keeps the best."""

import subprocess
import sys

import pytest

from app.jobs.messages import Failed, FailureKind
from app.jobs.tuning_work import FitDone, FitStepped, FitTask, TuningWork
from core.evaluation.fitting.fitted import fitted_parameters
from core.evaluation.labels import read_labels
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings, flatten
from hardware.simulation.objects import builtin_object
from tests.app.jobs.hosts import ListenedHost

pytestmark = pytest.mark.system

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
def fitting():
    fitting = ListenedHost(TuningWork, "tunes")
    yield fitting
    fitting.host.close()


def test_the_windows_process_can_import_it():
    heavy = ("optuna", "numba", "open3d", "pybullet", "core.reconstruction")
    program = (
        "import sys, app.cli, app.jobs.tuning_work; import core.evaluation.fitting.containability; "
        f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def task(objects, n_trials):
    parameters = apply_settings(Parameters(), QUICK)
    return FitTask(objects, "mesh", 1, parameters, "default", fitted_parameters([FRICTION]), n_trials)


def test_trials_are_reported_and_the_end_holds_what_was_found(fitting, objects):
    done = fitting.do(TuningWork.fit, task(objects, 3))
    steps = [event.step for event in fitting.of(FitStepped)]
    assert [step.trial.number for step in steps] == [0, 1, 2]
    assert isinstance(done, FitDone) and not done.is_cut_short
    assert done.provenance.seeds == (4,) and done.provenance.search["done"] == 3
    found = flatten(done.parameters)
    assert found[FRICTION] == steps[-1].best.values[FRICTION]
    assert found["containability.omega_threshold"] == steps[-1].best.score.threshold
    assert set(done.named) == {FRICTION, "containability.omega_threshold"}


def test_a_cancelled_fit_ends_with_the_best(fitting, objects):
    fitting.host.start(TuningWork.fit, task(objects, 1000))
    fitting.wait_for(FitStepped)
    fitting.host.cancel()
    found = fitting.wait()
    assert isinstance(found, FitDone), found
    assert found.is_cut_short
    assert found.provenance.search["done"] < 1000


def test_a_mesh_that_is_none_is_reported(fitting, objects):
    objects[0].mesh.write_text("no mesh at all\n")
    failed = fitting.do(TuningWork.fit, task(objects, 3))
    assert isinstance(failed, Failed) and failed.kind is FailureKind.EXPLAINED
    assert "without a single container" in failed.sentence
