"""Ctrl-C and SIGTERM while the main thread is busy, and after it."""

import ctypes
import os
import signal
from threading import Event, Timer

import pytest

from app.cli.interrupts import Interrupts
from tests.patience import HANG_S


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
