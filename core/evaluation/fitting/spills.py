"""Measured spills: a CSV that says what a real cup, or that of the ground-truth simulation, spilled."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from core.errors import InputError
from core.files import read_csv, reason
from core.formats import excerpt

_NEEDED = ("object", "theta", "indent", "spilled")
COLUMNS = (*_NEEDED, "n_pour", "seed")
_MOST_DIGITS = 9


@dataclass(frozen=True)
class SpillMeasurement:
    """One pour that somebody counted.

    Attributes:
        name: the object's; it was upright as its mesh is.
        theta_rad: direction of the ray from the footprint's centre to the pivot, against the base x-axis.
        indent_m: L_idt, distance of the pivot from the footprint's centre.
        spilled: candies beside the object.
        n_pour: candies in the cup; none: as in the parameters.
        seed: of the packing that is imagined; none: as in the parameters.
    """

    name: str
    theta_rad: float
    indent_m: float
    spilled: float
    n_pour: int | None = None
    seed: int | None = None


def read_spills(path: Path) -> tuple[SpillMeasurement, ...]:
    """Read measurements: columns object, theta (rad), indent (m), spilled; n_pour and seed may be there, too.

    Raises:
        InputError: the file cannot be read, or a row of it cannot be used.
    """
    try:
        known, rows = read_csv(path)
    except (OSError, ValueError) as error:
        raise InputError(
            f"The spills {path} cannot be read ({reason(error)}); give a CSV in UTF-8 with the columns "
            f"{', '.join(_NEEDED)}."
        ) from error
    missing = [name for name in _NEEDED if name not in known]
    if missing:
        raise InputError(
            f"The spills {path} lack the column {missing[0]}; needed are {', '.join(_NEEDED)} (theta in rad "
            "against the base x-axis, indent in m)."
        )
    if not rows:
        raise InputError(f"The spills {path} hold no measurement; write a row for each pour.")
    return tuple(_measurement(path, number, row) for number, row in enumerate(rows, 2))


def write_spills(path: Path, measurements: Sequence[SpillMeasurement]) -> None:
    """Write what `read_spills` reads.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(COLUMNS)
            writer.writerows(_row(one) for one in measurements)
    except OSError as error:
        raise InputError(
            f"The spills cannot be written to {path} ({error.strerror}); name another file."
        ) from error


def _measurement(path: Path, number: int, row: Mapping[str, str | None]) -> SpillMeasurement:
    name = (row["object"] or "").strip()
    if not name:
        raise InputError(f"In {path}, line {number} names no object.")
    theta, indent, spilled = (_number(path, number, row, column) for column in _NEEDED[1:])
    n_pour, seed = (_whole(path, number, row, column) for column in COLUMNS[4:])
    if abs(indent) > 1:
        raise InputError(f"In {path}, line {number}, an indent of {indent:g} is none in metres.")
    if spilled < 0 or (n_pour is not None and spilled > n_pour) or n_pour == 0:
        raise InputError(f"In {path}, line {number}, {spilled:g} candies cannot have been spilled.")
    return SpillMeasurement(name, theta, indent, spilled, n_pour, seed)


def _number(path: Path, number: int, row: Mapping[str, str | None], column: str) -> float:
    text = (row[column] or "").strip()
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise InputError(f"In {path}, line {number}, '{excerpt(text)}' in the column {column} is no number.")
    return value


def _whole(path: Path, number: int, row: Mapping[str, str | None], column: str) -> int | None:
    text = (row.get(column) or "").strip()
    if not text:
        return None
    if not text.isdecimal() or len(text) > _MOST_DIGITS:
        raise InputError(
            f"In {path}, line {number}, '{excerpt(text)}' in the column {column} is no whole number."
        )
    return int(text)


def _row(one: SpillMeasurement) -> tuple[object, ...]:
    rest = ("" if one.n_pour is None else one.n_pour, "" if one.seed is None else one.seed)
    return (one.name, f"{one.theta_rad:.6f}", f"{one.indent_m:.6f}", f"{one.spilled:g}", *rest)
