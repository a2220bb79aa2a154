"""PyBullet, loaded at its first use and quietly: only workers ever get there.

The process that shows the results imports the imagination's modules too; it must neither wait for the physics
engine nor carry it, and the engine's greeting must not end up in people's pipes.
"""

from __future__ import annotations

from typing import Any

from core.quiet import quiet


class _Engine:
    """Stands for the module `pybullet`."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(_load(), name)
        setattr(self, name, value)  # found at once from now on: these calls are counted in millions
        return value


def _load() -> Any:
    """Import PyBullet, which greets from C."""
    with quiet(2):
        import pybullet

        return pybullet


bullet: Any = _Engine()
