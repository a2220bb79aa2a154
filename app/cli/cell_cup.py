"""What the commands do that enter a cell's cup, and let its arm go through a pour without candies."""

from __future__ import annotations

from app.cli.cell_commands import MM, cell_of_name
from app.cli.operators import PrintingOperator, TerminalOperator
from app.cli.terminal import TerminalReporter
from app.operations.calibration import cup as entering
from app.operations.calibration import cup_entry
from app.operations.calibration import dry_run as running
from core.errors import InputError


def cup(
    name: str,
    is_taught: bool,
    station_mm: tuple[float, float, float] | None,
    measures_mm: tuple[float | None, float | None, float | None, float | None],
    masses_kg: tuple[float | None, float | None],
) -> None:
    """Enter a cup; what is not said stays as it is."""
    if is_taught and station_mm is not None:
        raise InputError("The station is either taught or typed; leave out one of the two.")
    path, settings = cell_of_name(name)
    held = cup_entry.entry_of(settings)
    station_m = held.station_m
    if is_taught:
        station_m = cup_entry.read_taught_station(path)
    elif station_mm is not None:
        x, y, z = station_mm
        station_m = x / MM, y / MM, z / MM
    payload_kg, cup_kg = (
        known if given is None else given
        for given, known in zip(masses_kg, (held.payload_kg, held.cup_kg), strict=True)
    )
    entry = cup_entry.CupEntry(station_m, cup_entry.changed_cup(held.cup, measures_mm), payload_kg, cup_kg)
    with TerminalReporter() as terminal:
        found = entering.enter_cup(path, entry, terminal)
    print(f"{found.sentence[:1].upper()}{found.sentence[1:]}.")
    if found.reason:
        print(f"From others: {found.reason}")
    print(f"Next: poursight cell dry-run {name}")


def dry_run(name: str, is_confirmed: bool) -> None:
    """Let the arm go through a pour with an empty cup."""
    path, _ = cell_of_name(name)
    with TerminalReporter() as terminal:
        operator = PrintingOperator(path.parent) if is_confirmed else TerminalOperator(path.parent, terminal)
        found = running.dry_run(path, terminal, operator)
    print(f"The arm went through a pour: {found.sentence}.\n{found.run}")
    print(f"Next: poursight scan --session DIR --cell {path}")
