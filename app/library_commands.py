"""What the commands on the library do: listing sessions, and exporting one."""

from __future__ import annotations

import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from app.library.exporting import export_html, export_pdf, export_zip, report_is_current
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import PourScore, SessionSummary
from app.terminal import TerminalReporter
from core.session import Session
from core.workers import WorkerPool

_PIPE_WIDTH = 1000
"""Enough for any row: what is piped is not wrapped."""
_COLUMNS = ("created", "name", "from", "verdict", "P", "outcome", "MB", "folder")


def sessions(text: str) -> None:
    """List the sessions, or those that hold every word of a text."""
    library = Library((sessions_folder(),))
    found = library.refresh()
    if text:
        found = library.search(text)
    if not found:
        print(f"No sessions{f' with {text!r}' if text else ''} in {sessions_folder()}.", file=sys.stderr)
        return
    table = Table(*_COLUMNS, box=None, pad_edge=False)
    table.columns[-1].overflow = "fold"  # a path that is cut off is of no use
    for summary in found:
        table.add_row(*_cells(summary))
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = _PIPE_WIDTH
    console.print(table)


def export(
    session_folder: Path,
    html: Path | None,
    pdf: Path | None,
    zip_file: Path | None,
    overwrite: bool,
    workers: int | None,
) -> None:
    """Export a session as each of the files that are named; its report is written anew where it is old."""
    session = Session.open(session_folder).path
    if (html or pdf) and not report_is_current(session):
        from app import commands

        commands.report(session, workers)
    if html is not None:
        export_html(session, html, overwrite)
        print(f"Exported: {html}")
    with WorkerPool(1) as pool, TerminalReporter() as reporter:
        if pdf is not None:
            export_pdf(session, pdf, pool, reporter, overwrite)
            print(f"Exported: {pdf}")
        if zip_file is not None:
            export_zip(session, zip_file, reporter, overwrite)
            print(f"Exported: {zip_file}")


def _cells(summary: SessionSummary) -> tuple[str, ...]:
    made = summary.created_here
    return (
        summary.created if made is None else f"{made:%Y-%m-%d %H:%M}",
        summary.name,
        summary.source,
        summary.verdict_words,
        _percent(summary.chosen or summary.best),
        summary.problem or _outcome(summary),
        f"{summary.size_bytes / 1e6:.1f}",
        str(summary.path),
    )


def _outcome(summary: SessionSummary) -> str:
    return summary.outcome if summary.n_spilled is None else f"{summary.n_spilled} spilled"


def _percent(score: PourScore | None) -> str:
    return "" if score is None else f"{100 * score.p:.0f} %"
