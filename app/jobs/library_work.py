"""What is done with whole sessions, for a host process: exporting them, and taking exported ones in."""

from __future__ import annotations

from pathlib import Path

from app.jobs.face import JobFace
from app.jobs.service import Service
from app.jobs.session_work import SessionTask, working_on
from app.library.exporting import export_html, export_pdf, export_zip, report_is_current
from app.library.importing import import_zip
from app.remembered import remembered_parameters
from core.parameters import Parameters
from core.workers import WorkerPool


class LibraryWork(Service):
    """Exports and imports sessions; a file that exists is replaced, because the file dialog has asked."""

    def export_html(self, face: JobFace, session: Path, target: Path) -> Path:
        """Write a session's report as one HTML file, anew if it is older than the session; return `target`.

        Raises:
            InputError: the target cannot be written.
            StageError: the session holds nothing to report.
        """
        _bring_report_up_to_date(face, session)
        export_html(session, target, overwrite=True)
        return target

    def export_pdf(self, face: JobFace, session: Path, target: Path) -> Path:
        """Print a session's report as PDF; see `export_html`."""
        _bring_report_up_to_date(face, session)
        with WorkerPool(1) as pool:
            export_pdf(session, target, pool, face, overwrite=True)
        return target

    def export_zip(self, face: JobFace, session: Path, target: Path) -> Path:
        """Pack a session's folder and return `target`.

        Raises:
            InputError: the target cannot be written.
            SessionError: the session cannot be read, or changed meanwhile.
        """
        export_zip(session, target, face, overwrite=True)
        return target

    def import_zip(self, face: JobFace, archive: Path, root: Path) -> Path:
        """Unpack an exported session into a new folder in `root`, and return that.

        Raises:
            InputError: the file is no session that was exported.
            SessionError: the session in it cannot be opened, or the disk is full.
        """
        return import_zip(archive, root, face)


def _bring_report_up_to_date(face: JobFace, session: Path) -> None:
    """Write the report with the parameters that the session was made with, not those that somebody tries."""
    if report_is_current(session):
        return
    preset, parameters = remembered_parameters(session) or ("default", Parameters())
    task = SessionTask(session, parameters, preset)
    with WorkerPool() as pool, working_on(task, pool, face) as pipeline:
        pipeline.report()
