"""What is done with whole sessions, for a host process: exporting them, and taking exported ones in."""

from __future__ import annotations

from pathlib import Path

from app.jobs.service import JobReporter, Service
from app.library.exchange import export_html, export_model, export_pdf, export_zip, import_zip
from app.operations.session import bring_report_up_to_date
from core.workers import WorkerPool


class LibraryWork(Service):
    """Exports and imports sessions; a file that exists is replaced, because the file dialog has asked."""

    def export_html(self, reporter: JobReporter, session: Path, target: Path) -> Path:
        """Write a session's report as one HTML file, rewritten if it is out of date; return `target`.

        Raises:
            InputError: the target cannot be written.
            StageError: the session holds nothing to report.
        """
        bring_report_up_to_date(session, reporter)
        export_html(session, target, overwrite=True)
        return target

    def export_pdf(self, reporter: JobReporter, session: Path, target: Path) -> Path:
        """Print a session's report as PDF; see `export_html`."""
        bring_report_up_to_date(session, reporter)
        with WorkerPool(1) as pool:
            export_pdf(session, target, pool, reporter, overwrite=True)
        return target

    def export_model(self, reporter: JobReporter, session: Path, target: Path) -> Path:  # noqa: ARG002
        """Write a session's model in its photographed colours and return `target`.

        Raises:
            InputError: the target cannot be written.
            SessionError: the session has no coloured model.
        """
        export_model(session, target, overwrite=True)
        return target

    def export_zip(self, reporter: JobReporter, session: Path, target: Path) -> Path:
        """Pack a session's folder and return `target`.

        Raises:
            InputError: the target cannot be written.
            SessionError: the session cannot be read, or changed meanwhile.
        """
        export_zip(session, target, reporter, overwrite=True)
        return target

    def import_zip(self, reporter: JobReporter, archive: Path, root: Path) -> Path:
        """Unpack an exported session into a new folder in `root`, and return that.

        Raises:
            InputError: the file is no session that was exported.
            SessionError: the session in it cannot be opened, or the disk is full.
        """
        return import_zip(archive, root, reporter)
