"""Ctrl-C and SIGTERM while the main thread is busy, and after it."""

import ctypes
import os
import signal
from threading import Event, Timer

import pytest

from app.cli.interrupts import Interrupts
from app.cli.operators import TerminalOperator
from app.cli.terminal import TerminalReporter
from core.errors import Cancelled
from tests.patience import HANG_S, wait_until


@pytest.fixture(autouse=True)
def _as_on_a_terminal():
    """A shell lets what it starts in the background ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def send(number):
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_heard_while_the_main_thread_is_in_c(number):
    libc, lock = ctypes.CDLL(None), ctypes.create_string_buffer(64)
    libc.pthread_mutex_lock(lock)
    with Interrupts(lambda: libc.pthread_mutex_unlock(lock)):
        Timer(0.05, send, [number]).start()
        libc.pthread_mutex_lock(lock)  # no signal ends it, only what hears the signal meanwhile


def test_each_request_is_heard_and_none_afterwards():
    heard, before = [], signal.getsignal(signal.SIGINT)
    twice = Event()

    def hear():
        heard.append(1)
        if len(heard) == 2:
            twice.set()

    with Interrupts(hear) as interrupts:
        send(signal.SIGINT)
        assert not interrupts.was_terminated
        send(signal.SIGTERM)
        assert twice.wait(HANG_S)
        assert interrupts.was_terminated
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        send(signal.SIGINT)
        Event().wait(HANG_S)  # another thread may get the signal: the main thread hears of it in a moment
    assert len(heard) == 2


def test_after_sigterm_nobody_is_asked_whether_to_go_on(monkeypatch, tmp_path):
    monkeypatch.setattr("app.cli.terminal._PATIENCE_S", HANG_S)
    asked = []
    monkeypatch.setattr(TerminalReporter, "ask", lambda _self, question: asked.append(question))
    with TerminalReporter() as terminal:
        send(signal.SIGTERM)
        wait_until(lambda: terminal._interrupts.was_terminated and terminal._leaving is not None)
        with pytest.raises(Cancelled, match="at rest where it was stopped"):
            TerminalOperator(tmp_path, terminal).confirm_recovery(Cancelled("Stopped."), is_repeated=False)
        terminal._leaving.cancel()
    assert asked == []
