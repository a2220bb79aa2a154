"""How long the tests wait for what must come: no test hangs on the pace of the machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from tests.awake import in_time

HANG_S = 600.0
"""Longer than anything takes on any machine: only what never comes reaches it."""


def wait_until(is_so: Callable[[], Any], within_s: float = HANG_S) -> None:
    """Wait until something is so; a test that says within which time asserts that.

    Raises:
        AssertionError: it never is.
        TooLate: it is not in the time that the test says.
    """
    began_s = time.monotonic()
    while not is_so():
        waited_s = time.monotonic() - began_s
        if within_s < HANG_S:
            in_time(waited_s, within_s, "what was waited for")
        assert waited_s < HANG_S, "it never came to that"
        time.sleep(0.002)
