"""Keeping what C libraries print out of people's terminals and pipes."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet(descriptor: int) -> Iterator[None]:
    """Send file descriptor 1 or 2 to nowhere: C writes to it past `sys.stdout` and `sys.stderr`."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept, nowhere = os.dup(descriptor), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, descriptor)
        yield
    finally:
        os.dup2(kept, descriptor)
        os.close(kept)
        os.close(nowhere)
