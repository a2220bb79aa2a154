"""Two sessions side by side, in numbers and words for people."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.library.session_folder import remembered_parameters
from app.library.summary import PourScore, SessionSummary, summarize
from core.errors import SessionError
from core.mesh import TriangleMesh
from core.mesh_file import read_ply
from core.mesh_topology import topology
from core.parameters import Parameters, describe, difference
from core.pipeline.session_view import SessionView
from core.stages import STAGE_NAMES

MM, ML = 1000.0, 1e6
UNKNOWN = "–"


@dataclass(frozen=True)
class Row:
    """One line of a comparison; a value that a session does not have is "–".

    Attributes:
        group: what the line belongs to: Object, Imagination, Pour, Time or Parameters.
        what: is compared.
        a: the first session's value, with its unit.
        b: the second session's.
        difference: from a to b, with its unit; empty if they are alike or it says nothing more.
    """

    group: str
    what: str
    a: str
    b: str
    difference: str = ""

    @property
    def is_same(self) -> bool:
        """Whether both sessions say the same."""
        return self.a == self.b


@dataclass(frozen=True)
class Comparison:
    """Two sessions and the lines that compare them, in the order of the work."""

    a: SessionSummary
    b: SessionSummary
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class _Side:
    """What is compared of one session."""

    summary: SessionSummary
    view: SessionView
    mesh: TriangleMesh | None
    parameters: tuple[str, Parameters] | None


def compare(a: Path, b: Path) -> Comparison:
    """Compare two sessions; reads both meshes, so call it in a thread.

    Raises:
        SessionError, InputError: one of them cannot be read.
    """
    sides = _read(a), _read(b)
    rows = (*_object(*sides), *_imagination(*sides), *_pour(*sides), *_times(*sides), *_parameters(*sides))
    return Comparison(sides[0].summary, sides[1].summary, rows)


def _read(session: Path) -> _Side:
    summary = summarize(session)
    if summary.problem:
        raise SessionError(summary.problem)
    view = SessionView.of(summary.path)
    mesh = read_ply(summary.path / view.source / "mesh.ply") if view.source in view.records else None
    return _Side(summary, view, mesh, remembered_parameters(summary.path))


def _object(a: _Side, b: _Side) -> list[Row]:
    group = "Object"
    volumes = _volume_ml(a.mesh), _volume_ml(b.mesh)
    return [
        Row(group, "from", a.summary.source or UNKNOWN, b.summary.source or UNKNOWN),
        _number_row(group, "views", a.summary.n_views or None, b.summary.n_views or None),
        Row(group, "size (x, y, z)", _size(a.mesh), _size(b.mesh), _size_difference(a.mesh, b.mesh)),
        _number_row(group, "volume of the material", *volumes, "ml"),
    ]


def _imagination(a: _Side, b: _Side) -> list[Row]:
    group, one, two = "Imagination", a.summary, b.summary
    return [
        Row(group, "verdict", one.verdict_words or UNKNOWN, two.verdict_words or UNKNOWN),
        _number_row(group, "Omega", one.omega, two.omega, decimals=3),
        _number_row(group, "threshold of Omega", one.omega_threshold, two.omega_threshold, decimals=3),
        _number_row(group, "capacity by its hull", one.capacity_share, two.capacity_share, decimals=3),
    ]


def _pour(a: _Side, b: _Side) -> list[Row]:
    group, one, two = "Pour", a.summary, b.summary
    best = _percent(one.best), _percent(two.best)
    chosen = _percent(one.chosen), _percent(two.chosen)
    return [
        _number_row(group, "best P", *best, "%"),
        Row(group, "chosen pour", _place(a), _place(b)),
        Row(group, "chosen by", _chooser(one), _chooser(two)),
        _number_row(group, "P of the chosen pour", *chosen, "%"),
        Row(group, "pours that the arm can make", _n_feasible(a), _n_feasible(b)),
        _number_row(group, "pours made or begun", one.n_runs, two.n_runs),
        Row(group, "outcome", one.outcome or UNKNOWN, two.outcome or UNKNOWN),
    ]


def _times(a: _Side, b: _Side) -> list[Row]:
    seconds = [{stage: record.seconds for stage, record in side.view.records.items()} for side in (a, b)]
    return [
        _number_row("Time", stage, seconds[0].get(stage), seconds[1].get(stage), "s", 1)
        for stage in STAGE_NAMES
        if stage in seconds[0] or stage in seconds[1]
    ]


def _parameters(a: _Side, b: _Side) -> list[Row]:
    group = "Parameters"
    if a.parameters is None or b.parameters is None:
        said = [side.parameters[0] if side.parameters else "not recorded" for side in (a, b)]
        return [Row(group, "preset", *said)]
    (preset_a, values_a), (preset_b, values_b) = a.parameters, b.parameters
    units = {fact.name: fact.unit for fact in describe()}
    rows = [
        _parameter_row(name, value_a, value_b, units[name])
        for name, (value_a, value_b) in difference(values_b, values_a).items()
    ]
    return [Row(group, "preset", preset_a, preset_b), *rows]


def _parameter_row(name: str, a: Any, b: Any, unit: str) -> Row:
    """Return the line of a parameter by its name for --set; lengths are shown in millimetres."""
    apart = _value(b - a, unit, sign="+") if _is_number(a) and _is_number(b) else ""
    return Row("Parameters", name, _value(a, unit), _value(b, unit), apart)


def _value(value: Any, unit: str, sign: str = "") -> str:
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    scale, shown_unit = (MM, "mm") if unit == "m" else (1, unit)
    numbers = value if isinstance(value, tuple) else (value,)
    return f"{', '.join(f'{number * scale:{sign}.6g}' for number in numbers)} {shown_unit}".rstrip()


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _number_row(
    group: str, what: str, a: float | None, b: float | None, unit: str = "", decimals: int = 0
) -> Row:
    """Return a line of two numbers; the difference is that of the numbers as shown, with its sign."""
    text_a, text_b = (
        UNKNOWN if number is None else f"{number:.{decimals}f} {unit}".rstrip() for number in (a, b)
    )
    if a is None or b is None or text_a == text_b:
        return Row(group, what, text_a, text_b)
    apart = round(b, decimals) - round(a, decimals)
    return Row(group, what, text_a, text_b, f"{apart:+.{decimals}f} {unit}".rstrip())


def _size(mesh: TriangleMesh | None) -> str:
    if mesh is None:
        return UNKNOWN
    return " x ".join(f"{length:.0f}" for length in mesh.extents_m * MM) + " mm"


def _size_difference(a: TriangleMesh | None, b: TriangleMesh | None) -> str:
    if a is None or b is None or _size(a) == _size(b):
        return ""
    apart_mm = np.round(b.extents_m * MM) - np.round(a.extents_m * MM)
    return ", ".join(f"{length:+.0f}" for length in apart_mm) + " mm"


def _volume_ml(mesh: TriangleMesh | None) -> float | None:
    """Return the volume; none of a mesh that encloses none."""
    return mesh.volume_m3 * ML if mesh is not None and topology(mesh).is_closed else None


def _percent(score: PourScore | None) -> float | None:
    return None if score is None else 100 * score.p


def _place(side: _Side) -> str:
    """Say where the chosen pour is made from, in the words of the report."""
    from core.report.sentences import direction_text

    chosen, pours = side.summary.chosen, side.view.pours
    if chosen is None or pours is None:
        return UNKNOWN
    return f"from {direction_text(pours.theta_rad[chosen.i])}, {pours.indent_m[chosen.j] * MM:.0f} mm out"


def _chooser(summary: SessionSummary) -> str:
    if summary.chosen is None:
        return UNKNOWN
    return f"the operator: {summary.operator_reason}" if summary.operator_reason else "the program"


def _n_feasible(side: _Side) -> str:
    """Say how many pours the arm can make."""
    motions = side.view.motions
    if motions is None:
        return UNKNOWN
    return f"{sum(pour.is_feasible for pour in motions.pours)} of {len(motions.pours)}"
