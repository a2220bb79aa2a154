"""What the commands on sessions do: the stages, the report, the demo, and the library."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from app.cli.operators import PrintingOperator, TerminalOperator
from app.cli.options import STDOUT
from app.cli.parameters import NOTHING_CHOSEN, Choices
from app.cli.terminal import TerminalReporter, working
from app.library.exchange import check_target, export_html, export_pdf, export_zip
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.session_folder import UNFINISHED_SCAN
from app.library.summary import PourScore, SessionSummary
from app.operations import pouring
from app.operations.ahead import computing_ahead
from app.operations.scan_run import ScanRequest
from app.operations.scanning import is_mesh_file, scan_object
from app.operations.session import bring_report_up_to_date
from core.errors import InputError, NotAdvised
from core.files import write_json
from core.formats import excerpt
from core.imagination.advice import advice_against
from core.imagination.amount.result import amount_text
from core.imagination.imagination import Imagination
from core.imagination.retention.result import retention_sentence
from core.parameters import Parameters, flatten
from core.pipeline.pipeline import Pipeline
from core.report import omega_verdict_sentence, pours_sentence, risk_sentence, verdict_sentence
from core.scratch import ScratchFolder
from core.session import Session
from core.workers import WorkerPool
from hardware.cell import SIMULATED_CELL, read_cell
from hardware.simulation.objects import builtin_object

MM = 1000.0
_PIPE_WIDTH = 1000
"""Enough for any row: what is piped is not wrapped."""
_COLUMNS = ("created", "name", "from", "verdict", "P", "outcome", "MB", "folder")


def import_scan(folder: Path, session: Path) -> None:
    """Take a scan into a session."""
    with working(session, NOTHING_CHOSEN, None) as pipeline:
        scan = pipeline.import_scan(folder)
    print(f"{len(scan.frames)} views imported into {session}.")


def scan(
    session: Path,
    cell_file: Path | None,
    source: str | None,
    choices: Choices,
    workers: int | None,
    request: ScanRequest,
    is_confirmed: bool,
) -> None:
    """Scan an object in a cell, with a real arm after a confirmation; say whether the scan is good enough."""
    settings = read_cell(cell_file or SIMULATED_CELL)
    if source is not None:
        is_mesh_file(source)  # an unknown name is refused before anything is started
    terminal = TerminalReporter()
    operator = PrintingOperator(session) if is_confirmed else TerminalOperator(session, terminal)
    with working(session, choices, workers, terminal=terminal) as pipeline:
        with computing_ahead(pipeline.parameters, pipeline.pool, session / UNFINISHED_SCAN):
            request = replace(request, cell_file=cell_file)
            scan_object(pipeline, settings, source, request, operator=operator)
        quality = pipeline.quality()
        pipeline.colors()
    print(f"{len(quality.views)} views in {session}.")
    for reason in quality.reasons:
        print(f"Verdict on the scan: {reason}")


def reconstruct(session: Path, choices: Choices, workers: int | None) -> None:
    """Reconstruct a session's scan."""
    with working(session, choices, workers, is_existing=True) as pipeline:
        result = pipeline.reconstruction()
        pipeline.colors()
    width, depth, height = (MM * result.mesh.extents_m).round()
    print(
        f"Reconstructed {width:.0f} x {depth:.0f} x {height:.0f} mm, {len(result.mesh.faces)} faces: "
        f"{session / 'reconstruction' / 'mesh.ply'}"
    )


def imagine(
    source: Path, choices: Choices, workers: int | None, json_file: Path | None, session: Path | None
) -> None:
    """Imagine a session or a mesh and print the answer."""
    with ScratchFolder() as scratch:
        is_mesh = not source.is_dir()
        folder = (session or scratch / "session") if is_mesh else source
        if session is not None and not is_mesh:
            raise InputError(f"{source} is a session already: leave out --session, which is for meshes.")
        with working(folder, choices, workers, is_existing=not is_mesh) as pipeline:
            if is_mesh:
                pipeline.import_mesh(source)
            result = pipeline.imagination()
            table = answer_table(result, pipeline.parameters)
    if json_file is not None and json_file == STDOUT:
        json.dump(table, sys.stdout, indent=2)
        print()
        return
    if json_file is not None:
        _write_answer(json_file, table)
    _print_verdict(result)
    if table["advice"] is not None:
        print(table["advice"])


def report(session: Path, workers: int | None) -> None:
    """Write a session's report."""
    with working(session, NOTHING_CHOSEN, workers, is_existing=True) as pipeline:
        path = pipeline.report()
    print(f"Report: {path}")


def demo(name: str, out: Path, choices: Choices, workers: int | None) -> None:
    """Do the whole job with a built-in object."""
    builtin_object(name)  # an unknown name is refused before anything is started
    with working(out, choices, workers) as pipeline:
        with computing_ahead(pipeline.parameters, pipeline.pool, out / UNFINISHED_SCAN):
            scan_object(pipeline, read_cell(), name)
        result = pipeline.imagination()
        _print_verdict(result)
        if result.choice is not None and not pouring.was_poured(pipeline.session):
            _pour_if_advised(pipeline, out)
        path = pipeline.report()
    print(f"Report: {path}")


def _pour_if_advised(pipeline: Pipeline, out: Path) -> None:
    try:
        pouring.pour(pipeline, pouring.cell_of(pipeline.session, None), PrintingOperator(out))
    except NotAdvised as advice:
        print(f"{advice} 'poursight pour {out} --yes --anyway' pours all the same.")


def sessions(text: str) -> None:
    """List the sessions, or those that hold every word of a text."""
    library = Library((sessions_folder(),))
    found = library.refresh()
    if text:
        found = library.search(text)
    if not found:
        wanted = f" with '{excerpt(text)}'" if text else ""
        print(f"No sessions{wanted} in {sessions_folder()}.", file=sys.stderr)
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
    session: Path,
    html: Path | None,
    pdf: Path | None,
    zip_file: Path | None,
    overwrite: bool,
    workers: int | None,
) -> None:
    """Export a session as each of the files that are named; its report is rewritten if it is out of date."""
    folder = Session.open(session).path
    for target in filter(None, (html, pdf, zip_file)):
        check_target(target, overwrite)  # refused now, not after the report was rendered
    with WorkerPool(1) as pool, TerminalReporter() as terminal:
        if (html or pdf) and (path := bring_report_up_to_date(folder, terminal, workers)):
            print(f"Report: {path}")
        if html is not None:
            export_html(folder, html, overwrite)
            print(f"Exported: {html}")
        if pdf is not None:
            export_pdf(folder, pdf, pool, terminal, overwrite)
            print(f"Exported: {pdf}")
        if zip_file is not None:
            export_zip(folder, zip_file, terminal, overwrite)
            print(f"Exported: {zip_file}")


def answer_table(result: Imagination, parameters: Parameters) -> dict[str, Any]:
    """Return what `poursight imagine --json` writes; pours are null when none were imagined."""
    found, grid = result.containability, result.grid
    footprint = found.footprint
    return {
        "omega": found.omega,
        "is_open_container": found.is_open_container,
        "is_undecided": found.is_undecided,
        "n_drop": found.n_drop,
        "n_in": found.n_in,
        "footprint": None
        if footprint is None
        else {"center_m": footprint.center_m.tolist(), "axis_rad": footprint.axis_rad},
        "verdict": None if found.verdict is None else found.verdict.to_table(),
        "capacity": None if result.capacity is None else result.capacity.to_table(),
        "holding": None if result.retention is None else result.retention.to_table(),
        "n_pour": parameters.pouring.n_pour if grid is None else grid.n_pour,
        "amount": None if result.amount is None else result.amount.to_table(),
        "p": None if grid is None else grid.p.tolist(),
        "p_spread": None if grid is None else grid.p_spread.tolist(),
        "choice": None if result.choice is None else result.choice.to_table(),
        "risk": None if result.risk is None else result.risk.to_table(),
        "advice": _advice(result, parameters) or None,
        "paper_choice": None if result.paper_choice is None else result.paper_choice.to_table(),
        "seconds": {"containability": result.containability_s, "pouring": result.pouring_s},
        "seed": parameters.seed,
        "parameters": flatten(parameters),
    }


def _advice(result: Imagination, parameters: Parameters) -> str:
    if result.choice is None:
        return ""
    i, j = result.choice.i, result.choice.j
    return advice_against(result.risk, i, j, parameters.risk.wanted_clean)


def _print_verdict(result: Imagination) -> None:
    print(verdict_sentence(result.containability))
    if result.containability.verdict is not None:
        print(omega_verdict_sentence(result.containability))
    if result.retention is not None:
        print(retention_sentence(result.retention))
    if result.capacity is not None and result.capacity.remark:
        print(result.capacity.remark)
    if result.amount is not None and result.containability.is_open_container:
        print(amount_text(result.amount))
    print(pours_sentence(result.containability, result.grid, result.choice))
    if result.grid and result.risk and result.choice and result.paper_choice:
        print(risk_sentence(result.grid, result.risk, result.choice, result.paper_choice))


def _write_answer(path: Path, table: dict[str, Any]) -> None:
    try:
        write_json(path, table)
    except OSError as error:
        raise InputError(
            f"The answer cannot be written to {path} ({error.strerror}); name another file."
        ) from error


def _cells(summary: SessionSummary) -> tuple[str, ...]:
    made = summary.created_here
    return (
        summary.created if made is None else f"{made:%Y-%m-%d %H:%M}",
        summary.name.encode("utf-8", "backslashreplace").decode(),
        summary.source,
        summary.verdict_words,
        _percent(summary.chosen or summary.best),
        summary.problem or _outcome(summary),
        f"{summary.size_bytes / 1e6:.1f}",
        str(summary.path).encode("utf-8", "backslashreplace").decode(),
    )


def _outcome(summary: SessionSummary) -> str:
    return summary.outcome if summary.n_spilled is None else f"{summary.n_spilled} spilled"


def _percent(score: PourScore | None) -> str:
    return "" if score is None else f"{100 * score.p:.0f} %"
