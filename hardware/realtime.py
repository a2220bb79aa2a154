"""Precedence of the processes that keep an arm's pace over all that merely computes."""

from __future__ import annotations

import os
from contextlib import suppress

_PRIORITY = 1
"""The lowest of the real-time ones: before every ordinary process, behind the system's own."""


def take_precedence() -> bool:
    """Let this thread, and those it starts from now on, run before every ordinary process.

    Returns whether the system allows it: Linux does to root, and to those who are given `rtprio` in
    /etc/security/limits.conf. Without it the arm is driven as well, but on a busy machine more slowly.
    """
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))
        return True
    return False
