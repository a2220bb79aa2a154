"""Ctrl-C and kill -9 while the demo runs: out within two seconds, and the same command continues."""

import os
import random
import signal
import subprocess
import sys
import time

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
    said = ""
    for line in process.stderr:
        if line.startswith(f"{stage}:"):
            return said
        said += line
    raise AssertionError(f"{stage} was never reached; said was: {said}")


def run(*words):
    process = start(*words)
    stdout, stderr = process.communicate(timeout=240)
    return process.returncode, stdout, stderr


def interrupt_in(stage, out):
    """Start or continue the demo, send Ctrl-C in a stage, and return what was said before it."""
    process = start_demo(out)
    said = wait_for_stage(process, stage)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the whole group
    interrupted = time.perf_counter()
    _, stderr = process.communicate(timeout=30)
    assert time.perf_counter() - interrupted < 2, stage
    assert process.returncode == 1, stage
    assert "Traceback" not in stderr
    assert "Stopped on request" in stderr
    return said


def scans_on(out):
    code, _, said = run("scan", "--session", out, "--object=bowl")
    assert code == 0, said


def test_ctrl_c_ends_within_two_seconds_and_the_session_continues(tmp_path):
    out = tmp_path / "demo"
    interrupt_in("scan", out)
    interrupt_in("reconstruction", out)
    assert "scan:" not in interrupt_in("containability", out), "finished stages must not run again"
    assert "containability:" in interrupt_in("pouring", out)
    assert run("imagine", out)[0] == 0
    assert "containability:" not in interrupt_in("pour", out)
    assert pour_runs(out)[-1].sentence.startswith("Stopped during")


def test_ctrl_c_after_the_pour_does_not_pour_again(tmp_path):
    out = tmp_path / "demo"
    interrupt_in("scan", out)
    scans_on(out)
    assert "scan:" not in interrupt_in("evidence", out), "the other command's scan is this session's"
    code, stdout, said = run("demo", f"--out={out}", *QUICK)
    assert code == 0, said
    assert "Open container" in stdout
    assert (out / "report.html").is_file()
    assert "pouring:" not in said, "finished stages must not run again"
    assert "pour:" not in said, "a pour that was made is not made again"


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
