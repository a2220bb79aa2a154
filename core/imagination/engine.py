"""PyBullet, loaded at its first use and quietly: only workers ever get there.

The process that shows the results imports the imagination's modules too; it must neither wait for the physics
engine nor carry it, and the engine's greeting must not end up in people's pipes.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class _Engine:
    """Stands for the module `pybullet`."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(_load(), name)
        setattr(self, name, value)  # found at once from now on: these calls are counted in millions
        return value


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what C code prints on file descriptor 2 from the terminal; exceptions still come through."""
    sys.stderr.flush()
    kept, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(null)


def _load() -> Any:
    """Import PyBullet, which greets from C."""
    with quiet():
        import pybullet

        return pybullet


bullet: Any = _Engine()
