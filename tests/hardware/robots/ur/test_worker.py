"""The worker process dies, freezes, or is left behind: it is noticed, the arm stands, and nothing remains."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import psutil
import pytest

from hardware.errors import RobotError, RobotLost, RobotStopped
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import in_time, within
from tests.hardware.robots.ur.bench import FAR, HOME, STANDS_WITHIN_S, Bench, driver
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

NOTICED_WITHIN_S = 0.5
SUSPENDED_RESTS_WITHIN_S = 2.5
STANDS_STILL_S = 0.6
"""Longer than the controller's watchdog waits for a word."""
SIGNALS = pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])


@SIGNALS
@pytest.mark.parametrize("kind", ["move_joints", "follow"])
def test_in_a_move_it_is_noticed_and_the_arm_stands(bench: Bench, number: int, kind: str) -> None:
    move = bench.begin(kind)
    worker = bench.worker()
    with within(STANDS_WITHIN_S + 0.1, "coming to rest"):
        with within(NOTICED_WITHIN_S, "being noticed"):
            os.kill(worker, number)
            with pytest.raises(RobotLost, match="recover"):
                move.wait(HANG_S)
        wait_until(lambda: not bench.is_moving())
    assert not psutil.pid_exists(worker)
    assert bench.stays_where_it_is()
    bench.works_again()


@SIGNALS
def test_the_watchdog_alone_makes_the_arm_stand(bench: Bench, number: int) -> None:
    bench.begin("follow")
    bench.robot._connected().dashboard.close()
    os.kill(bench.worker(), number)
    in_time(bench.seconds_to_rest(), STANDS_WITHIN_S, "coming to rest")
    # Without new targets the arm comes to rest at the last one, which may be before the watchdog has starved.
    wait_until(lambda: "watchdog starved" in bench.controller.command("log"), STANDS_WITHIN_S)
    bench.works_again()


@pytest.mark.parametrize("kind", ["move_joints", "follow"])
def test_a_machine_that_stood_still_is_no_fault(bench: Bench, kind: str) -> None:
    move = bench.begin(kind)
    everything = " ".join(map(str, [bench.controller.pid, bench.worker(), os.getpid()]))
    command = f"kill -STOP {everything}; sleep {STANDS_STILL_S}; kill -CONT {everything}"
    subprocess.run(["sh", "-c", command], check=True)
    move.wait(HANG_S)
    assert np.allclose(bench.joints(), FAR, atol=5e-3), "it went on to where it was sent"


def test_a_standing_arm_whose_worker_froze_says_so(bench: Bench) -> None:
    os.kill(bench.worker(), signal.SIGSTOP)
    time.sleep(NOTICED_WITHIN_S)
    with pytest.raises(RobotLost):
        bench.robot.state()
    with pytest.raises(RobotLost):
        bench.robot.set_tool_output(0, True)
    bench.works_again()


def test_a_stop_takes_the_second_path_and_says_so(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    move = bench.begin("follow")
    os.kill(bench.worker(), signal.SIGSTOP)
    with caplog.at_level(logging.WARNING):
        bench.robot.stop()
    in_time(bench.seconds_to_rest(), 0.2, "coming to rest")
    assert "through its dashboard" in caplog.text
    with pytest.raises((RobotStopped, RobotLost)):
        move.wait(1)
    assert bench.stays_where_it_is()
    bench.works_again()


def test_leaving_stops_the_arm_and_leaves_nothing(controller: ControllerProcess) -> None:
    threads = set(threading.enumerate())
    with driver(controller.address) as robot:
        bench = Bench(controller, robot)
        move = bench.begin("move_joints")
        worker = bench.worker()
    assert not bench.is_moving()
    assert not psutil.pid_exists(worker)
    assert set(threading.enumerate()) <= threads
    with pytest.raises(RobotError):
        move.wait(0)


def test_leaving_a_frozen_or_killed_worker_leaves_nothing(controller: ControllerProcess) -> None:
    for number in (signal.SIGSTOP, signal.SIGKILL):
        threads = set(threading.enumerate())
        began_s = time.monotonic()
        with driver(controller.address) as robot:
            worker = Bench(controller, robot).worker()
            os.kill(worker, number)
        in_time(time.monotonic() - began_s, 4)
        assert not psutil.pid_exists(worker)
        assert set(threading.enumerate()) <= threads


def test_a_program_that_is_killed_takes_its_worker_along_and_the_arm_stands(
    controller: ControllerProcess,
) -> None:
    program = subprocess.Popen(
        [sys.executable, __file__, controller.address],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    bench = Bench(controller, driver(controller.address))
    assert program.stdout is not None
    worker = int(program.stdout.readline())
    wait_until(bench.is_moving)
    with within(STANDS_WITHIN_S + 0.1):
        program.kill()
        program.communicate()
        wait_until(lambda: not bench.is_moving(), 1)
    wait_until(lambda: not psutil.pid_exists(worker), 2)
    assert bench.stays_where_it_is()


if __name__ == "__main__":
    with driver(sys.argv[1]) as arm:
        arm.move_joints([HOME, HOME + 2.0], 1.0, 4.0)
        print(arm._connected().worker.process_id, flush=True)
        time.sleep(60)


SUSPENDED = """
import sys
import numpy as np
from core.motion.trajectory import JointTrajectory
from tests.hardware.robots.ur.bench import FAR, HOME, driver
from tests.patience import HANG_S

times_s = np.arange(0, 8, 0.008)
share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
with driver(sys.argv[1]) as robot:
    move = robot.follow(JointTrajectory(times_s, HOME + np.outer(share, FAR - HOME)))
    print("moves", flush=True)
    try:
        move.wait(HANG_S)
    except Exception as error:
        print(type(error).__name__, error, flush=True)
    try:
        robot.move_joints([robot.state().joints_rad, HOME], 1.0, 1.0)
    except Exception as error:
        print("refused", error, flush=True)
"""


def test_a_program_that_was_suspended_does_not_go_on(controller: ControllerProcess) -> None:
    bench = Bench(controller, driver(controller.address))
    with subprocess.Popen(
        [sys.executable, "-c", SUSPENDED, controller.address], stdout=subprocess.PIPE, text=True
    ) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == "moves\n"
        wait_until(lambda: np.abs(bench.truth()["speeds_rad_s"]).max() > 0.1)
        os.kill(program.pid, signal.SIGSTOP)
        with within(SUSPENDED_RESTS_WITHIN_S):
            wait_until(lambda: not bench.is_moving())
        assert bench.stays_where_it_is(0.5)
        os.kill(program.pid, signal.SIGCONT)
        assert program.stdout.readline().startswith("RobotStopped This program stood still")
        assert program.stdout.readline().startswith("refused")
        assert bench.stays_where_it_is()
