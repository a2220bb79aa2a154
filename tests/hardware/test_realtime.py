"""Precedence over what merely computes: taken where the system allows it, done without where not."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest

from hardware.realtime import take_precedence
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.hardware.robots.ur.bench import HOME, Bench, bent_way, driver
from tests.patience import HANG_S

pytestmark = [pytest.mark.system, pytest.mark.punctual]


def in_a_thread(function):
    """The precedence of a thread ends with it."""
    told = []
    thread = threading.Thread(target=lambda: told.append(function()))
    thread.start()
    thread.join()
    return told[0]


@pytest.fixture
def busy():
    """Three processes for each core that do nothing but compute."""
    computing = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(3 * os.cpu_count())
    ]
    yield
    for process in computing:
        process.kill()
        process.wait()


def test_it_is_told_whether_precedence_was_given():
    def taken():
        return take_precedence(), os.sched_getscheduler(0)

    is_given, policy = in_a_thread(taken)
    assert policy == (os.SCHED_RR if is_given else os.SCHED_OTHER)
    assert os.sched_getscheduler(0) == os.SCHED_OTHER, "nobody else has it"


def test_who_may_not_take_it_goes_on_without(monkeypatch):
    def refuse(*_):
        raise PermissionError("Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert take_precedence() is False


def test_an_arm_keeps_its_pace_on_a_busy_machine(busy):
    if not in_a_thread(take_precedence):
        pytest.skip("this system gives nobody precedence")
    way = bent_way()
    with (
        ControllerProcess(version="5.11", joints_rad=HOME) as controller,
        driver(controller.address) as robot,
    ):
        bench = Bench(controller, robot)
        began_s = bench.truth()["time_s"]
        robot.follow(way).wait(HANG_S)
        assert way.duration_s < bench.truth()["time_s"] - began_s < way.duration_s + 0.5
