"""What the commands do, once their words are understood."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.answer import answer_table
from app.listing import short
from app.presets import named_preset
from app.remembered import remember_parameters, remembered_parameters
from app.scanning import ScanWishes, scan_object
from app.terminal import TerminalReporter
from core.errors import InputError, SessionError
from core.files import write_json
from core.imagination.amount.words import amount_text
from core.imagination.holding.words import holding_sentence
from core.imagination.imagine import WORKER_MODULE, Imagination
from core.parameters import Parameters, apply_settings, difference, load_preset
from core.pipeline.pipeline import Pipeline
from core.report import paper_verdict_sentence, pours_sentence, risk_sentence, verdict_sentence
from core.session import Session
from core.session.pour_runs import note_emptied
from core.workers import WorkerPool


@dataclass(frozen=True)
class Choices:
    """Parameters as chosen on the command line; nothing chosen means what the session used before."""

    preset: str | None
    settings: list[str]
    seed: int | None

    def parameters(self, session: Path) -> tuple[str, Parameters]:
        """Return the preset's name and the parameters.

        Raises:
            InputError: an unknown preset or parameter, or a value out of its range.
        """
        preset, parameters = self._base(session)
        settings: dict[str, Any] = dict(named_values("--set", self.settings))
        if self.seed is not None:
            settings["seed"] = self.seed
        return preset, apply_settings(parameters, settings)

    def _base(self, session: Path) -> tuple[str, Parameters]:
        remembered = remembered_parameters(session) if self.preset is None else None
        preset = named_preset(self.preset or "default")
        return remembered or (preset, load_preset(preset))


def named_values(option: str, texts: Sequence[str]) -> dict[str, str]:
    """Return what was given as `NAME=VALUE`, by name.

    Raises:
        InputError: one lacks its value.
    """
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"'{option} {text}' lacks a value: write {option} name=value.")
        found[name.strip()] = value.strip()
    return found


def import_scan(folder: Path, session_folder: Path) -> None:
    """Take a scan into a session."""
    with _working(session_folder, Choices(None, [], None), None) as pipeline:
        scan = pipeline.import_scan(folder)
    print(f"{len(scan.frames)} views imported into {session_folder}.")


def reconstruct(session_folder: Path, choices: Choices, workers: int | None) -> None:
    """Reconstruct a session's scan."""
    with _working(session_folder, choices, workers, existing=True) as pipeline:
        result = pipeline.reconstruction()
    width, depth, height = (1000 * result.mesh.extents_m).round()
    print(
        f"Reconstructed {width:.0f} x {depth:.0f} x {height:.0f} mm, {len(result.mesh.faces)} faces: "
        f"{session_folder / 'reconstruction' / 'mesh.ply'}"
    )


def imagine(
    source: Path, choices: Choices, workers: int | None, json_file: Path | None, session: Path | None
) -> None:
    """Imagine a session or a mesh and print the answer."""
    with tempfile.TemporaryDirectory(prefix="poursight-") as scratch:
        is_mesh = not source.is_dir()
        folder = (session or Path(scratch) / "session") if is_mesh else source
        if session is not None and not is_mesh:
            raise InputError(f"{source} is a session already: leave out --session, which is for meshes.")
        with _working(folder, choices, workers, existing=not is_mesh) as pipeline:
            if is_mesh:
                pipeline.import_mesh(source)
            result = pipeline.imagination()
            table = answer_table(result, pipeline.parameters)
    if json_file is not None and str(json_file) == "-":
        json.dump(table, sys.stdout, indent=2)
        print()
        return
    if json_file is not None:
        _write_answer(json_file, table)
    _print_verdict(result)


def report(session_folder: Path, workers: int | None) -> None:
    """Write a session's report."""
    with _working(session_folder, Choices(None, [], None), workers, existing=True) as pipeline:
        path = pipeline.report()
    print(f"Report: {path}")


def scan(
    session_folder: Path,
    cell_file: Path | None,
    source: str | None,
    choices: Choices,
    workers: int | None,
    wishes: ScanWishes,
) -> None:
    """Scan an object in a cell and say whether the scan is good enough."""
    from hardware.cell import SIMULATED_CELL, read_cell

    settings = read_cell(cell_file or SIMULATED_CELL)
    with _working(session_folder, choices, workers) as pipeline:
        scan_object(pipeline, settings, source, wishes)
        quality = pipeline.quality()
    print(f"{len(quality.views)} views in {session_folder}.")
    for reason in quality.reasons:
        print(f"Verdict on the scan: {reason}")


def plan(session_folder: Path, cell_file: Path | None, workers: int | None) -> None:
    """Say which pours the arm can make."""
    from app import pouring

    with _working(session_folder, Choices(None, [], None), workers, existing=True) as pipeline:
        pouring.plan(pipeline, cell_file)


def pour(
    session_folder: Path,
    cell_file: Path | None,
    is_confirmed: bool,
    is_emptied: bool,
    workers: int | None,
) -> None:
    """Pour, after a confirmation; into an object that was emptied the first cup again."""
    from app import pouring

    face = TerminalReporter()
    with _working(session_folder, Choices(None, [], None), workers, existing=True, face=face) as pipeline:
        if is_emptied:
            note_emptied(pipeline.session.path)
        folder = pouring.pour(pipeline, None if is_confirmed else face, cell_file)
    print(f"Kept in {folder}.")


def outcome(session_folder: Path, spilled: int | None, remarks: str) -> None:
    """Enter what was spilled in the newest pour."""
    from app.outcome import enter_outcome

    with Session.open(session_folder) as session:
        print(enter_outcome(session.path, spilled, remarks).sentence)


def demo(name: str, out: Path, choices: Choices, workers: int | None) -> None:
    """Do the whole job with a built-in object."""
    from app import pouring
    from hardware.cell import read_cell
    from hardware.simulation.objects import builtin_object

    builtin_object(name)  # an unknown name is refused before anything is started
    with _working(out, choices, workers) as pipeline:
        scan_object(pipeline, read_cell(), name)
        result = pipeline.imagination()
        _print_verdict(result)
        if result.choice is not None and not pouring.was_poured(pipeline.session):
            pouring.pour(pipeline, None, None)
        path = pipeline.report()
    print(f"Report: {path}")


@contextmanager
def _working(
    folder: Path,
    choices: Choices,
    workers: int | None,
    existing: bool = False,
    face: TerminalReporter | None = None,
) -> Iterator[Pipeline]:
    """Hold the session, start the workers, show progress, and remember the parameters."""
    if existing and not folder.exists():
        raise SessionError(
            f"There is no session {folder}; 'poursight import FOLDER --session {folder}' makes one."
        )
    preset, chosen = choices.parameters(folder)
    with WorkerPool(workers) as pool, face or TerminalReporter() as reporter:
        pool.start(WORKER_MODULE)
        _print_difference(preset, chosen)
        session = Session.open(folder) if existing else Session.create_or_open(folder)
        with session:
            remember_parameters(folder, preset, chosen)
            yield Pipeline(session, chosen, pool, reporter, preset)


def _print_verdict(result: Imagination) -> None:
    print(verdict_sentence(result.containability))
    if result.containability.verdict is not None:
        print(paper_verdict_sentence(result.containability))
    if result.holding is not None:
        print(holding_sentence(result.holding))
    if result.capacity is not None and result.capacity.explanation:
        print(result.capacity.explanation)
    if result.amount is not None and result.containability.is_open_container:
        print(amount_text(result.amount))
    print(pours_sentence(result.containability, result.grid, result.choice))
    if result.grid and result.risk and result.choice and result.paper_choice:
        print(risk_sentence(result.grid, result.risk, result.choice, result.paper_choice))


def _print_difference(preset: str, parameters: Parameters) -> None:
    base = load_preset(preset) if not Path(preset).suffix else Parameters()
    for name, (before, after) in difference(parameters, base).items():
        print(f"{name} = {short(after)} (preset {preset}: {short(before)})", file=sys.stderr)


def _write_answer(path: Path, table: dict[str, Any]) -> None:
    try:
        write_json(path, table)
    except OSError as error:
        raise InputError(
            f"The answer cannot be written to {path} ({error.strerror}); name another file."
        ) from error
