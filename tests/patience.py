"""How long the tests wait for what must come: no test hangs on the pace of the machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

HANG_S = 600.0
"""Longer than anything takes on any machine: only what never comes reaches it."""


def wait_until(is_so: Callable[[], Any], within_s: float = HANG_S) -> None:
    """Wait until something is so; a test that says within which time asserts that.

    Raises:
        AssertionError: it never is.
    """
    began_s = time.monotonic()
    while not is_so():
        assert time.monotonic() - began_s < within_s, "it never came to that"
        time.sleep(0.002)
