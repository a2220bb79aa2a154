"""A host process works, tells, cancels, survives faults, and is missed when it dies."""

from __future__ import annotations

import os
import queue
import signal
import time

import psutil
import pytest

from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind, Finished, News, Progressed, Warned
from app.jobs.service import Service
from core.errors import InputError


class _Counting(Service):
    """A service that counts."""

    count = 0
    noted = ""

    def add(self, face, number):
        self.count += number
        face.progress("adding", 1, 2)
        face.warn("Careful.")
        face.tell(("added", number))
        return self.count

    def fail(self, face):
        raise InputError("There is no such thing; look elsewhere.")

    def crash(self, face):
        raise ZeroDivisionError("by accident")

    def die(self, face):
        os.kill(os.getpid(), signal.SIGKILL)

    def wait(self, face):
        while True:
            face.raise_if_cancelled()
            time.sleep(0.01)

    def hang(self, face):
        time.sleep(60)

    def note(self, word):
        self._tell(News(word))


@pytest.fixture
def heard():
    return queue.Queue()


@pytest.fixture
def host(heard):
    host = Host(_Counting, "counts", heard.put)
    host.open()
    yield host
    host.close()


def _last(heard):
    """Everything up to the end of a job."""
    messages = []
    while not messages or not isinstance(messages[-1], Finished | Failed):
        messages.append(heard.get(timeout=20))
    return messages


def test_a_job_tells_on_its_way_and_its_service_remembers(host, heard):
    host.start(_Counting.add, 2)
    messages = _last(heard)
    assert [type(message) for message in messages] == [Progressed, Warned, News, Finished]
    assert messages[-1].result == 2
    host.start(_Counting.add, 3)
    assert _last(heard)[-1].result == 5


def test_what_cannot_be_done_is_a_sentence_and_a_fault_has_its_traceback(host, heard):
    host.start(_Counting.fail)
    failed = _last(heard)[-1]
    assert (failed.kind, failed.sentence) == (
        FailureKind.EXPLAINED,
        "There is no such thing; look elsewhere.",
    )
    host.start(_Counting.crash)
    fault = _last(heard)[-1]
    assert fault.kind is FailureKind.FAULT
    assert "ZeroDivisionError" in fault.details


def test_a_cancelled_job_ends_and_the_next_one_runs(host, heard):
    host.start(_Counting.wait)
    host.cancel()
    assert _last(heard)[-1].kind is FailureKind.CANCELLED
    host.start(_Counting.add, 1)
    assert _last(heard)[-1].result == 1


def test_an_order_is_carried_out_beside_a_job(host, heard):
    host.start(_Counting.wait)
    host.order(_Counting.note, "now")
    assert heard.get(timeout=20) == News("now")
    host.cancel()
    _last(heard)


def test_a_killed_host_is_told_of_and_replaced(host, heard):
    host.start(_Counting.die)
    failed = _last(heard)[-1]
    assert failed.kind is FailureKind.DIED
    assert "counts" in failed.sentence
    host.start(_Counting.add, 1)
    assert _last(heard)[-1].result == 1


def test_a_hanging_job_does_not_keep_the_host_from_closing(host, heard):
    host.start(_Counting.hang)
    time.sleep(0.5)
    pid = host.pid
    began = time.monotonic()
    host.close()
    assert time.monotonic() - began < 4
    assert not psutil.pid_exists(pid)
