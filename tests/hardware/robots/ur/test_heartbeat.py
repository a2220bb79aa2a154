"""A program that is suspended is told from one that is only busy, however long nothing of it is heard."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import numpy as np
import pytest

from hardware.robots.ur import heartbeat
from hardware.robots.ur.heartbeat import STOOD_STILL_S, Heartbeat
from hardware.robots.ur.messages import Pulse
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.hardware.robots.ur.bench import FAR, Bench, driver
from tests.patience import wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

LOOK_S = 0.01


@pytest.fixture
def busy_program() -> Iterator[subprocess.Popen[bytes]]:
    """It computes for ever."""
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as program:
        yield program
        program.kill()


@pytest.fixture
def beaten() -> Pulse:
    """Heard once, and then no more."""
    pulse = Pulse()
    pulse.beat()
    return pulse


def look_for(listener: Heartbeat, seconds: float) -> str:
    """Look as the worker does until something is wrong, or some looks' worth of time is over."""
    for _ in range(int(seconds / LOOK_S)):
        if problem := listener.problem():
            return problem
        time.sleep(LOOK_S)
    return ""


def test_a_busy_program_may_be_unheard_and_a_suspended_one_may_not(
    busy_program: subprocess.Popen[bytes], beaten: Pulse
) -> None:
    listener = Heartbeat(beaten, busy_program.pid)
    assert look_for(listener, 2 * STOOD_STILL_S) == ""
    busy_program.send_signal(signal.SIGSTOP)
    assert look_for(listener, 0.8 * STOOD_STILL_S) == "", "nor at once"
    assert "stood still for 2 s" in look_for(listener, 2 * STOOD_STILL_S)


def test_a_program_that_hangs_at_work_is_said_in_the_end(
    busy_program: subprocess.Popen[bytes], beaten: Pulse, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(heartbeat, "BUSY_S", 1.0)
    assert "hung for 1 s" in look_for(Heartbeat(beaten, busy_program.pid), 60)


def test_a_program_that_is_heard_is_not_looked_at(beaten: Pulse) -> None:
    asleep = Heartbeat(beaten, os.getpid())
    for _ in range(int(1.5 * STOOD_STILL_S / LOOK_S)):
        beaten.beat()
        assert asleep.problem() == ""
        time.sleep(LOOK_S)


HOLDS_ITS_INTERPRETER = """
import sys, time
import numpy as np
from core.motion.trajectory import JointTrajectory
from tests.hardware.robots.ur.bench import FAR, HOME, driver
from tests.patience import HANG_S

times_s = np.arange(0, 9, 0.008)
share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
with driver(sys.argv[1]) as robot:
    move = robot.follow(JointTrajectory(times_s, HOME + np.outer(share, FAR - HOME)))
    sys.setswitchinterval(60)
    time.sleep(0.1)  # whoever waits for the interpreter from now on does not ask for it sooner
    began_s = time.monotonic()
    while time.monotonic() - began_s < 3:  # no other thread of this process runs meanwhile
        pass
    held_s = time.monotonic() - began_s
    sys.setswitchinterval(0.005)
    try:
        move.wait(HANG_S)
        print("arrived", held_s, flush=True)
    except Exception as error:
        print(error, flush=True)
"""


def test_a_call_that_holds_the_interpreter_does_not_cost_the_motion(controller: ControllerProcess) -> None:
    program = subprocess.run(
        [sys.executable, "-c", HOLDS_ITS_INTERPRETER, controller.address],
        capture_output=True,
        text=True,
        check=True,
    )
    said, _, held_s = program.stdout.partition(" ")
    assert said == "arrived", program.stdout
    assert float(held_s) > 1.1 * STOOD_STILL_S, "else it shows nothing"
    bench = Bench(controller, driver(controller.address))
    wait_until(lambda: not bench.is_moving())
    assert np.allclose(bench.joints(), FAR, atol=5e-3)
