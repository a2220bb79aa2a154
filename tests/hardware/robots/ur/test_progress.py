"""How far a motion is, by what the worker read since it began."""

from __future__ import annotations

import time
from types import SimpleNamespace

import pytest

from hardware.errors import RobotLost
from hardware.robots.ur.link import UrMove, WorkerLink


def told(progress, time_s):
    """What a worker with this newest state tells of a motion that began at a time."""
    worker = SimpleNamespace(state=lambda: {"progress": progress, "time_s": time_s})
    return lambda since_s: WorkerLink.progress(worker, since_s)


@pytest.mark.parametrize(("time_s", "progress"), [(4.9, 0.0), (5.0, 0.7), (5.1, 0.7)])
def test_a_state_of_before_tells_nothing(time_s, progress):
    assert told(0.7, time_s)(5.0) == progress


def test_of_a_lost_worker_nothing_is_known():
    def lost():
        raise RobotLost("gone")

    assert WorkerLink.progress(SimpleNamespace(state=lost), 0.0) == 0.0


def test_a_motion_does_not_begin_with_the_end_of_the_one_before():
    states = [{"progress": 1.0, "time_s": time.monotonic()}]
    worker = SimpleNamespace(state=lambda: states[-1])
    move = UrMove("UR5", lambda since_s: WorkerLink.progress(worker, since_s), lambda: None)
    assert move.progress == 0.0
    states.append({"progress": 0.25, "time_s": time.monotonic()})
    assert move.progress == 0.25
