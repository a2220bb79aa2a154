"""Ctrl-C and kill -9 while the demo runs: out within two seconds, and the same command continues."""

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from core.session.pour_runs import pour_runs

QUICK = [
    "--object=bowl",
    "--set=containability.n_max=64",
    "--set=containability.n_min=40",
    "--set=containability.verdict=omega",
    "--set=risk.n_tries=4",
    "--set=pouring.n_pour=20",
    "--set=evidence.films=false",
]


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "app.cli", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        start_new_session=True,
    )


def start_demo(out):
    return start("demo", f"--out={out}", *QUICK)


def wait_for_stage(process, stage):
    for line in process.stderr:
        if line.startswith(stage):
            return
    raise AssertionError(f"{stage} was never reached")


def run(*words):
    process = start(*words)
    stdout, stderr = process.communicate(timeout=240)
    return process.returncode, stdout, stderr


def finish(out):
    code, stdout, stderr = run("demo", f"--out={out}", *QUICK)
    assert code == 0, stderr
    assert "Open container" in stdout
    assert (out / "report.html").is_file()
    return stderr


def scans_on(out):
    code, _, said = run("scan", "--session", out, "--object=bowl")
    assert code == 0, said


@pytest.mark.parametrize("stage", ["scan", "reconstruction", "containability", "pouring", "pour", "evidence"])
def test_ctrl_c_ends_within_two_seconds_and_the_session_continues(stage, tmp_path):
    out = tmp_path / "demo"
    process = start_demo(out)
    wait_for_stage(process, f"{stage}:")
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the whole group
    interrupted = time.perf_counter()
    _, stderr = process.communicate(timeout=30)
    assert time.perf_counter() - interrupted < 2
    assert process.returncode == 1
    assert "Traceback" not in stderr
    assert "Stopped on request" in stderr
    if stage == "evidence":
        said = finish(out)
        assert "pouring:" not in said, "finished stages must not run again"
        assert "pour:" not in said, "a pour that was made is not made again"
    elif stage == "pour":
        assert pour_runs(out)[-1].sentence.startswith("Stopped during")
    elif stage == "scan":
        scans_on(out)
    else:
        assert run("imagine", out)[0] == 0


def test_kill_9_at_a_random_moment_loses_no_finished_stage(tmp_path):
    out = tmp_path / "demo"
    generator = random.Random(5)
    for _ in range(3):
        process = start_demo(out)
        time.sleep(generator.uniform(1.0, 8.0))
        process.kill()
        process.communicate()
    scans_on(out)
    assert run("imagine", out)[0] == 0
