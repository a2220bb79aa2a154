"""How a process that computes behaves: quiet on stdout, deaf to Ctrl-C, and gone when its parent is."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import wait as wait_for_handles
from typing import NoReturn


def become_worker() -> None:
    """Call this first in a process that was spawned to compute."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # PyBullet and its EGL plugin write to file descriptor 1 from C; people pipe what is printed there.
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    threading.Thread(target=_die_with_parent, daemon=True).start()


@contextmanager
def children_deaf_to_interrupts() -> Iterator[None]:
    """Let processes spawned inside inherit an ignored SIGINT: Ctrl-C reaches the whole terminal group."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)


def _die_with_parent() -> NoReturn:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_handles([parent.sentinel])
    time.sleep(0.1)
    os._exit(1)
