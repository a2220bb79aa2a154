"""PyBullet, loaded at its first use and quietly: only workers ever get there.

The process that shows the results imports the imagination's modules too; it must neither wait for the physics
engine nor carry it, and the engine's greeting must not end up in people's pipes.
"""

from __future__ import annotations

import os
from typing import Any


class _Engine:
    """Stands for the module `pybullet`."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(_load(), name)
        setattr(self, name, value)  # found at once from now on: these calls are counted in millions
        return value


def _load() -> Any:
    """Import PyBullet with file descriptor 2 closed to the line it prints from C."""
    kept, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    try:
        import pybullet

        return pybullet
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(null)


bullet: Any = _Engine()
