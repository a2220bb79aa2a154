"""Ctrl-C and kill -9 while the demo runs: out within two seconds, and the same command continues."""

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from core.session.pour_runs import pour_runs
from tests.app.sessions import copied, made_once
from tests.awake import within
from tests.patience import HANG_S

pytestmark = pytest.mark.system

QUICK = [
    "--object=bowl",
    "--set=reconstruction.voxel_m=0.004",
    "--set=containability.n_max=64",
    "--set=containability.n_min=40",
    "--set=risk.n_tries=4",
    "--set=pouring.n_pour=20",
    "--set=evidence.films=false",
    "--set=capacity.n_fillings=1",
    "--set=capacity.n_aimed=20",
    "--set=capacity.lattice_points=50000",
    "--set=holding.n_load=6",
    "--set=holding.tilt_step_rad=0.2",
]
BY_OMEGA = [*QUICK, "--set=containability.verdict=omega"]


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "app.cli", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        start_new_session=True,
    )


def start_demo(out, settings):
    return start("demo", f"--out={out}", *settings)


def wait_for_stage(process, stage):
    said = ""
    for line in process.stderr:
        if line.startswith(f"{stage}:"):
            return said
        said += line
    raise AssertionError(f"{stage} was never reached; said was: {said}")


def run(*words):
    process = start(*words)
    stdout, stderr = process.communicate(timeout=HANG_S)
    return process.returncode, stdout, stderr


def interrupt_in(stage, out, settings=QUICK):
    """Start or continue the demo, send Ctrl-C in a stage, and return what was said before it."""
    process = start_demo(out, settings)
    said = wait_for_stage(process, stage)
    with within(2):
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the whole group
        _, stderr = process.communicate(timeout=HANG_S)
    assert process.returncode == 1, stage
    assert "Traceback" not in stderr
    assert "Stopped on request" in stderr
    return said


@pytest.fixture(scope="module")
def scanned_bowl(tmp_path_factory):
    """What the demo's first stage makes, begun by the demo and finished by another command."""

    def scan(folder):
        interrupt_in("scan", folder)
        code, _, said = run("scan", "--session", folder, "--object=bowl")
        assert code == 0, said

    return made_once(tmp_path_factory, "scanned_bowl", scan)


@pytest.fixture
def scanned(scanned_bowl, tmp_path):
    return copied(scanned_bowl, tmp_path / "demo")


@pytest.mark.punctual
def test_ctrl_c_in_the_scan_ends_within_two_seconds_and_the_demo_continues(tmp_path):
    out = tmp_path / "demo"
    interrupt_in("scan", out)
    assert "scan:" in interrupt_in("reconstruction", out)
    assert "scan:" not in interrupt_in("containability", out), "finished stages must not run again"


@pytest.mark.punctual
def test_ctrl_c_ends_within_two_seconds_and_the_session_continues(scanned):
    out = scanned
    assert "scan:" not in interrupt_in("containability", out), "another command's scan is this session's"
    assert "containability:" in interrupt_in("capacity", out)
    assert "containability:" not in interrupt_in("pouring", out)
    assert run("imagine", out)[0] == 0
    assert "containability:" not in interrupt_in("pour", out)
    assert pour_runs(out)[-1].sentence.startswith("Stopped during")


@pytest.mark.punctual
def test_ctrl_c_after_the_pour_does_not_pour_again(scanned):
    out = scanned
    before = interrupt_in("evidence", out, BY_OMEGA)
    assert "capacity:" not in before, "Omega asks for no filling"
    code, stdout, said = run("demo", f"--out={out}", *BY_OMEGA)
    assert code == 0, said
    assert "Open container" in stdout
    assert (out / "report.html").is_file()
    assert "pouring:" not in said, "finished stages must not run again"
    assert "pour:" not in said, "a pour that was made is not made again"


def test_kill_9_at_a_random_moment_loses_no_finished_stage(tmp_path):
    out = tmp_path / "demo"
    generator = random.Random(5)
    for _ in range(3):
        process = start_demo(out, QUICK)
        time.sleep(generator.uniform(1.0, 8.0))
        process.kill()
        process.communicate()
    code, _, said = run("scan", "--session", out, "--object=bowl")
    assert code == 0, said
    assert run("imagine", out)[0] == 0
