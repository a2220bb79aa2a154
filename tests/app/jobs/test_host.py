"""A host process works, reports, cancels, survives faults, and is missed when it dies."""

from __future__ import annotations

import os
import signal
import time

import psutil
import pytest

from app.jobs.messages import Event, FailureKind, Finished, Progressed, Warned
from app.jobs.service import Service
from core.errors import InputError
from tests.app.jobs.hosts import ListenedHost
from tests.awake import within


class _Counting(Service):
    """A service that counts."""

    count = 0
    noted = ""

    def add(self, reporter, number):
        self.count += number
        reporter.progress("adding", 1, 2)
        reporter.warn("Careful.")
        reporter.publish(("added", number))
        return self.count

    def fail(self, reporter):
        raise InputError("There is no such thing; look elsewhere.")

    def crash(self, reporter):
        raise ZeroDivisionError("by accident")

    def die(self, reporter):
        os.kill(os.getpid(), signal.SIGKILL)

    def wait(self, reporter):
        while True:
            reporter.raise_if_cancelled()
            time.sleep(0.01)

    def hang(self, reporter):
        reporter.publish("hangs")
        time.sleep(60)

    def note(self, word):
        self._send(Event(word))


@pytest.fixture
def counting():
    counting = ListenedHost(_Counting, "counts")
    counting.host.open()
    yield counting
    counting.host.close()


def test_a_job_reports_its_progress_and_its_service_remembers(counting):
    assert counting.do(_Counting.add, 2) == 2
    assert [type(message) for message in counting.messages] == [Progressed, Warned, Event, Finished]
    assert counting.do(_Counting.add, 3) == 5


def test_what_cannot_be_done_is_a_sentence_and_a_fault_has_its_traceback(counting):
    failed = counting.do(_Counting.fail)
    assert (failed.kind, failed.sentence) == (
        FailureKind.EXPLAINED,
        "There is no such thing; look elsewhere.",
    )
    fault = counting.do(_Counting.crash)
    assert fault.kind is FailureKind.FAULT
    assert "ZeroDivisionError" in fault.details


def test_a_cancelled_job_ends_and_the_next_one_runs(counting):
    counting.host.start(_Counting.wait)
    counting.host.cancel()
    assert counting.wait().kind is FailureKind.CANCELLED
    assert counting.do(_Counting.add, 1) == 1


def test_an_order_is_carried_out_beside_a_job(counting):
    counting.host.start(_Counting.wait)
    counting.host.order(_Counting.note, "now")
    assert counting.next() == Event("now")
    counting.host.cancel()
    assert counting.wait().kind is FailureKind.CANCELLED


def test_a_killed_host_is_reported_and_replaced(counting):
    failed = counting.do(_Counting.die)
    assert failed.kind is FailureKind.DIED
    assert "counts" in failed.sentence
    assert counting.do(_Counting.add, 1) == 1


def test_a_hanging_job_does_not_keep_the_host_from_closing(counting):
    counting.do(_Counting.hang, until=lambda event: event == "hangs")
    pid = counting.host.pid
    with within(4):
        counting.host.close()
    assert not psutil.pid_exists(pid)
