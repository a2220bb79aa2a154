"""One job at a time; cancelling acts within a second whatever the job does."""

from __future__ import annotations

import os
import signal
import time

import psutil
import pytest

from app.gui.desk import jobs as jobs_module
from app.gui.desk.jobs import Inbox, Jobs, RunningJob
from app.jobs.arm_events import ArmStatus
from app.jobs.host import Host
from app.jobs.messages import Event, FailureKind, Finished, Progressed, Warned
from app.jobs.service import Service
from tests.awake import within


class _Working(Service):
    """A service with jobs of all kinds."""

    def stubborn(self, reporter):
        time.sleep(60)

    def counting(self, reporter):
        for k in range(40):
            reporter.progress("counting", k + 1, 40)
            reporter.raise_if_cancelled()
            time.sleep(0.05)
        return 40

    def quick(self, reporter):
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


def test_a_job_reports_how_far_it_is_and_how_long_it_takes(jobs, host, qtbot):
    seen = []
    jobs.progressed.connect(lambda job: seen.append((job.stage, job.fraction, job.seconds_left)))
    with qtbot.waitSignal(jobs.finished) as ended:
        jobs.start("Count", "scan", host, _Working.counting)
    assert ended.args[1] == 40
    fractions = [fraction for _, fraction, _ in seen]
    assert fractions == sorted(fractions)
    assert any(left is not None and 0 <= left < 3 for _, _, left in seen)
    assert jobs.is_idle


def test_time_that_a_job_waits_says_nothing_about_its_pace(monkeypatch):
    now_s = 100.0
    monkeypatch.setattr(jobs_module.time, "monotonic", lambda: now_s)
    job = RunningJob("Scan", "scan", "", None, None)
    job.progress(Progressed("views", 0, 24))
    now_s = 112.0
    job.progress(Progressed("views", 6, 24))
    assert job.seconds_left == pytest.approx(36)
    job.pause()
    now_s = 712.0
    assert job.seconds_left is None
    job.resume()
    job.resume()  # also an answer to a question resumes
    assert job.seconds_left == pytest.approx(36)


def test_a_second_job_is_not_begun_beside_the_first(jobs, host, qtbot):
    jobs.start("Count", "scan", host, _Working.counting)
    jobs.start("Quick", "robot", host, _Working.quick)
    assert jobs.running.title == "Count"
    with qtbot.waitSignal(jobs.failed):
        jobs.cancel()


def test_a_job_that_does_not_listen_is_ended_within_a_second_and_a_bit(jobs, host, qtbot):
    with qtbot.waitSignal(jobs.finished):
        jobs.start("Quick", "scan", host, _Working.quick)
    jobs.start("Stubborn", "scan", host, _Working.stubborn)
    qtbot.wait(200)
    with within(1.5), qtbot.waitSignal(jobs.failed) as ended:
        jobs.cancel()
    assert ended.args[1].kind is FailureKind.CANCELLED


def test_a_killed_process_is_a_message_and_trying_again_works(jobs, host, qtbot):
    with qtbot.waitSignal(jobs.finished):
        jobs.start("Quick", "scan", host, _Working.quick)
    with qtbot.waitSignal(jobs.failed) as ended:
        jobs.start("Count", "scan", host, _Working.counting)
        os.kill(host.pid, signal.SIGKILL)
    job, failed = ended.args
    assert failed.kind is FailureKind.DIED
    with qtbot.waitSignal(jobs.finished):
        job.start_again()


def test_what_comes_after_a_job_is_begun_when_it_is_done(jobs, host, qtbot):
    results = []
    with qtbot.waitSignal(jobs.finished):
        jobs.start("Quick", "scan", host, _Working.quick, then=results.append)
    assert results == ["done"]


def test_a_host_that_moves_things_offers_no_second_try(jobs, qtbot):
    host = jobs.make_host(_Working, "moves", is_repeatable=False)
    with qtbot.waitSignal(jobs.finished) as ended:
        jobs.start("Quick", "robot", host, _Working.quick)
    assert ended.args[0].start_again is None


def test_closing_leaves_no_process_behind(jobs, host, qtbot):
    jobs.start("Stubborn", "scan", host, _Working.stubborn)
    qtbot.wait(500)
    pid = host.pid
    jobs.close()
    assert not psutil.pid_exists(pid)


def _status(problem):
    return Event(ArmStatus(None, None, problem))


def test_of_states_that_wait_only_the_newest_is_delivered_on_and_all_else_in_order(qtbot, qapp):
    delivered = []
    inbox = Inbox(lambda host, message: delivered.append(message), qapp)
    host = Host(Service, "waits", lambda message: None)
    sent = [Progressed("scan", 1, 9), _status("a"), Warned("first"), _status("b"), Progressed("scan", 2, 9)]
    for message in [*sent, Warned("second"), Finished(None)]:
        inbox.put(host, message)
    assert delivered == []
    qtbot.waitUntil(lambda: bool(delivered))
    assert delivered == [Warned("first"), sent[3], sent[4], Warned("second"), Finished(None)]


def test_hosts_do_not_overtake_each_other(qtbot, qapp):
    delivered = []
    inbox = Inbox(lambda host, message: delivered.append((host, message)), qapp)
    one, other = (Host(Service, name, lambda message: None) for name in ("one", "other"))
    inbox.put(one, _status("one"))
    inbox.put(other, _status("other"))
    qtbot.waitUntil(lambda: len(delivered) == 2)
    assert [host for host, _ in delivered] == [one, other]
