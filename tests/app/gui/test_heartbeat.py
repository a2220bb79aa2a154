"""The heartbeat notices a stall, and tells the program's own doing from other processes'."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

from app.gui.heartbeat import Heartbeat

STALL_S = 0.3


@pytest.fixture
def heartbeat(qtbot):
    made = Heartbeat()
    yield made
    made._timer.stop()


def beat_after(heartbeat, qtbot, stall):
    qtbot.wait(30)
    heartbeat.reset()
    stall()
    qtbot.wait(30)


def computes():
    began_s = time.thread_time()
    while time.thread_time() - began_s < STALL_S:
        pass


@pytest.mark.parametrize("stall", [computes, lambda: time.sleep(STALL_S)], ids=["computes", "waits"])
def test_what_keeps_the_window_from_its_events_is_its_own_stall(heartbeat, qtbot, stall):
    beat_after(heartbeat, qtbot, stall)
    assert heartbeat.worst_s > 0.9 * STALL_S
    assert heartbeat.worst_own_s > 0.9 * STALL_S


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs a processor that is shared")
def test_what_waits_for_a_processor_is_not_its_own_doing(heartbeat, qtbot):
    mine = os.sched_getaffinity(0)
    shared = {min(mine)}
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(3)]
    try:
        for process in others:
            os.sched_setaffinity(process.pid, shared)
        os.sched_setaffinity(0, shared)
        beat_after(heartbeat, qtbot, computes)
    finally:
        os.sched_setaffinity(0, mine)
        for process in others:
            process.kill()
            process.wait()
    assert heartbeat.worst_s > 2 * STALL_S, "a quarter of a processor"
    assert 0.9 * STALL_S < heartbeat.worst_own_s < 1.5 * STALL_S
