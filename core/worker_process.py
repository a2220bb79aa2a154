"""How a process that computes behaves: quiet on stdout, deaf to stopping signals, gone when its parent is."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import wait as wait_for_handles
from typing import NoReturn

_STOPPING = {signal.SIGINT, signal.SIGTERM}


def become_worker() -> None:
    """Call this first in a process that was spawned to compute."""
    for number in _STOPPING:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPPING)
    # PyBullet and its EGL plugin write to file descriptor 1 from C; people pipe what is printed there.
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    threading.Thread(target=_die_with_parent, daemon=True).start()


@contextmanager
def children_deaf_to_signals() -> Iterator[None]:
    """Let processes spawned inside not die of a signal to all: Ctrl-C, or what a service manager sends.

    Their parent hears it, keeps what is worth keeping, and ends them. What comes to it in here is only late.
    """
    resource_tracker.ensure_running()  # would be started with the first child, and unblocks what we block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPPING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _die_with_parent() -> NoReturn:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_handles([parent.sentinel])
    time.sleep(0.1)
    os._exit(1)
