"""Scans, for a host process: one host scans, another pours, and the window talks to both."""

from __future__ import annotations

from app.jobs.face import JobFace
from app.jobs.service import Service
from app.jobs.session_work import SessionTask


class ScanWork(Service):
    """Takes the views of an object."""

    def scan(self, face: JobFace, task: SessionTask) -> None:
        """To come."""

    def stop(self) -> None:
        """Stop the arm, at once."""
