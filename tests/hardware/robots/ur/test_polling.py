"""The threads in which ur_rtde receives look seldom while the arm stands, and often when it is asked."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from hardware.robots.ur.polling import PollingThreads
from tests.hardware.robots.ur.bench import HOME, NEAR, USUAL_SLACK_NS, Bench, may_change_threads, slack_ns
from tests.patience import HANG_S, wait_until

_COUNTED_S = 0.3

pytestmark = pytest.mark.skipif(not may_change_threads(), reason="needs Linux and CAP_SYS_NICE")


@pytest.fixture
def polled() -> Iterator[tuple[PollingThreads, int]]:
    """Threads, and the number of the one that they know."""
    is_over = Event()
    polling, thread = PollingThreads(), Thread(target=is_over.wait)
    with polling.starting():
        thread.start()
    assert thread.native_id is not None
    yield polling, thread.native_id
    is_over.set()
    thread.join()


def test_a_thread_that_is_not_asked_wakes_later(polled: tuple[PollingThreads, int]) -> None:
    polling, thread = polled
    polling.slacken()
    assert polling.are_slack
    assert slack_ns(thread) > 10 * USUAL_SLACK_NS
    polling.hasten(0.0)
    assert not polling.are_slack
    assert slack_ns(thread) <= USUAL_SLACK_NS
    assert os.sched_getscheduler(thread) == os.sched_getscheduler(0)


def test_haste_lasts_as_long_as_it_was_asked_for(polled: tuple[PollingThreads, int]) -> None:
    polling, thread = polled
    polling.hasten(HANG_S)
    polling.hasten(0.0)
    polling.slacken()
    assert not polling.are_slack
    assert slack_ns(thread) <= USUAL_SLACK_NS


def test_only_threads_that_began_inside_are_changed(polled: tuple[PollingThreads, int]) -> None:
    polling, _ = polled
    before = slack_ns(os.getpid())
    polling.slacken()
    assert slack_ns(os.getpid()) == before


def _wakes_per_s(process: int) -> float:
    """Of all its threads; a machine that is slower wakes them less often."""

    def count() -> int:
        states = [(task / "status").read_text() for task in Path(f"/proc/{process}/task").iterdir()]
        return sum(int(state.split("voluntary_ctxt_switches:")[1].split()[0]) for state in states)

    began_s, before = time.monotonic(), count()
    time.sleep(_COUNTED_S)
    return (count() - before) / (time.monotonic() - began_s)


@pytest.mark.system
def test_the_driver_of_a_standing_arm_wakes_seldom(bench: Bench) -> None:
    worker = bench.worker()
    # Two threads that look every 0.1 ms wake 5,800 times a second. A busy machine makes them do so at times.
    wait_until(lambda: bench.is_calm() and _wakes_per_s(worker) < 1500)


@pytest.mark.system
def test_a_move_is_driven_as_before(bench: Bench) -> None:
    wait_until(bench.is_calm)
    move = bench.robot.move_joints([HOME, NEAR], 1.0, 4.0)
    assert not bench.is_calm()
    move.wait(HANG_S)
    wait_until(bench.is_calm)
