"""One job at a time; cancelling acts within a second whatever the job does."""

from __future__ import annotations

import os
import signal
import time

import psutil
import pytest

from app.gui.desk.jobs import Jobs
from app.jobs.messages import FailureKind
from app.jobs.service import Service


class _Working(Service):
    """A service with jobs of all kinds."""

    def stubborn(self, face):
        time.sleep(60)

    def counting(self, face):
        for k in range(40):
            face.progress("counting", k + 1, 40)
            face.raise_if_cancelled()
            time.sleep(0.05)
        return 40

    def quick(self, face):
        return "done"


@pytest.fixture
def jobs(qtbot):
    jobs = Jobs()
    yield jobs
    jobs.close()


@pytest.fixture
def host(jobs):
    host = jobs.make_host(_Working, "works")
    host.open()
    return host


def test_a_job_tells_how_far_it_is_and_how_long_it_takes(jobs, host, qtbot):
    seen = []
    jobs.progressed.connect(lambda job: seen.append((job.stage, job.fraction, job.seconds_left)))
    with qtbot.waitSignal(jobs.finished, timeout=20_000) as ended:
        jobs.start("Count", "scan", host, _Working.counting)
    assert ended.args[1] == 40
    fractions = [fraction for _, fraction, _ in seen]
    assert fractions == sorted(fractions)
    assert any(left is not None and 0 <= left < 3 for _, _, left in seen)
    assert jobs.is_idle


def test_a_second_job_is_not_begun_beside_the_first(jobs, host, qtbot):
    jobs.start("Count", "scan", host, _Working.counting)
    jobs.start("Quick", "robot", host, _Working.quick)
    assert jobs.running.title == "Count"
    with qtbot.waitSignal(jobs.failed, timeout=20_000):
        jobs.cancel()


def test_a_job_that_does_not_listen_is_ended_within_a_second_and_a_bit(jobs, host, qtbot):
    with qtbot.waitSignal(jobs.finished, timeout=20_000):
        jobs.start("Quick", "scan", host, _Working.quick)
    jobs.start("Stubborn", "scan", host, _Working.stubborn)
    qtbot.wait(200)
    began = time.monotonic()
    with qtbot.waitSignal(jobs.failed, timeout=5_000) as ended:
        jobs.cancel()
    assert time.monotonic() - began < 1.5
    assert ended.args[1].kind is FailureKind.CANCELLED


def test_a_killed_process_is_a_message_and_trying_again_works(jobs, host, qtbot):
    with qtbot.waitSignal(jobs.finished, timeout=20_000):
        jobs.start("Quick", "scan", host, _Working.quick)
    with qtbot.waitSignal(jobs.failed, timeout=20_000) as ended:
        jobs.start("Count", "scan", host, _Working.counting)
        os.kill(host.pid, signal.SIGKILL)
    job, failed = ended.args
    assert failed.kind is FailureKind.DIED
    with qtbot.waitSignal(jobs.finished, timeout=20_000):
        job.start_again()


def test_what_comes_after_a_job_is_begun_when_it_is_done(jobs, host, qtbot):
    results = []
    with qtbot.waitSignal(jobs.finished, timeout=20_000):
        jobs.start("Quick", "scan", host, _Working.quick, then=results.append)
    assert results == ["done"]


def test_a_host_that_moves_things_offers_no_second_try(jobs, qtbot):
    host = jobs.make_host(_Working, "moves", is_repeatable=False)
    with qtbot.waitSignal(jobs.finished, timeout=20_000) as ended:
        jobs.start("Quick", "robot", host, _Working.quick)
    assert ended.args[0].start_again is None


def test_closing_leaves_no_process_behind(jobs, host, qtbot):
    jobs.start("Stubborn", "scan", host, _Working.stubborn)
    qtbot.wait(500)
    pid = host.pid
    jobs.close()
    assert not psutil.pid_exists(pid)
