"""The arm that pours, for a host process."""

from __future__ import annotations

from app.jobs.service import Service


class ArmWork(Service):
    """Holds a connected arm."""

    def stop(self) -> None:
        """Stop the arm, at once."""
