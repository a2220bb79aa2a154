"""Which of a session's JSON files holds what, and whether a file does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from core.formats.evaluations import Evaluation, TrialFile, check_evaluation, check_trial
from core.formats.scans import Views, check_views
from core.formats.tables import (
    Amount,
    Capacity,
    Choice,
    Collision,
    Drop,
    Evidence,
    Holding,
    Judgement,
    Motions,
    Plan,
    PlannedAmount,
    Pours,
    Quality,
    Reconstruction,
    Risk,
    TableOutcome,
    Unseen,
)
from core.formats.text import excerpt

_TABLES: Mapping[tuple[str, str], type] = {
    ("reconstruction", "result.json"): Reconstruction,
    ("reconstruction", "unseen.json"): Unseen,
    ("collision", "unseen.json"): Unseen,
    ("quality", "quality.json"): Quality,
    ("mesh", "collision.json"): Collision,
    ("collision", "collision.json"): Collision,
    ("containability", "containability.json"): Drop,
    ("containability", "capacity.json"): Capacity,
    ("containability", "holding.json"): Holding,
    ("judgement", "judgement.json"): Judgement,
    ("judgement", "capacity.json"): Capacity,
    ("judgement", "holding.json"): Holding,
    ("retention", "holding.json"): Holding,
    ("amount", "amount.json"): PlannedAmount,
    ("pouring", "amount.json"): Amount,
    ("pouring", "pours.json"): Pours,
    ("pouring", "risk.json"): Risk,
    ("pouring", "choice.json"): Choice,
    ("risk", "risk.json"): Risk,
    ("risk", "choice.json"): Choice,
    ("motion", "motion.json"): Motions,
    ("motion", "risk.json"): Risk,
    ("evidence", "evidence.json"): Evidence,
    ("plan", "plan.json"): Plan,
    ("table", "outcome.json"): TableOutcome,
}
"""By folder and name; earlier versions kept some of them in other folders."""
MADE_BY_REPORT = frozenset(folder for folder, _ in _TABLES) - {"mesh", "motion", "plan", "table"}
"""The folders of the stages that a report is made of."""


def kind_of(path: Path) -> type | None:
    """Return what a session's file must hold, by its folder and name; none if nothing is known of it."""
    return _TABLES.get((path.parent.name, path.name))


def check_table(content: bytes, kind: type) -> Any:
    """Return the table that JSON holds, with the keys of its kind and no others.

    Raises:
        ValueError: a key is missing or wrong; one short line says which.
    """
    try:
        table = _adapter(kind).validate_json(content, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        said = str(first["msg"]).removeprefix("Value error, ")
        raise ValueError(excerpt(f"{where}: {said}" if where else said)) from None
    if kind in _CHECKS:
        _CHECKS[kind](table)
    return table


@cache
def _adapter(kind: type) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def _check_pours(table: Pours) -> None:
    shape = len(table["theta_rad"]), len(table["indent_m"])
    grids = [table[name] for name in ("p", "p_spread", "n_in", "n_spilled", "pivot_m") if name in table]
    if 0 in shape or any(_shape(grid) != shape for grid in grids):
        raise ValueError("its grids do not have one size")
    counts = [pour for name in ("n_in", "n_spilled") for row in table.get(name, []) for pour in row]  # type: ignore[attr-defined]
    if len({len(pour) for pour in counts}) != 1 or not counts[0]:
        raise ValueError("its pours do not have one number of packings")
    if max(max(pour) for pour in counts) > table["n_pour"]:
        raise ValueError("n_in or n_spilled exceeds n_pour")


def _check_risk(table: Risk) -> None:
    tries = [pour for row in table["spilled"] for pour in row]
    if _shape(table["spilled"]) is None or not any(tries) or (table.get("n_cups", 1) == 1 and not all(tries)):
        raise ValueError("spilled: a pour has no tries")


def _check_motions(table: Motions) -> None:
    known = {(pour["i"], pour["j"]) for pour in table["pours"]}
    chosen = [table["choice"], table.get("free_choice") or table.get("paper_choice")]
    if chosen[1] is None:
        raise ValueError("free_choice: Field required")
    if any(choice is not None and (choice["i"], choice["j"]) not in known for choice in chosen):
        raise ValueError("choice: there is no such pour")


def _check_drop(table: Drop) -> None:
    if not all(low < high for low, high in zip(*table["aabb_m"], strict=True)):
        raise ValueError("aabb_m: its corners are exchanged")


def _shape(grid: Sequence[Sequence[Any]]) -> tuple[int, int] | None:
    """Return (rows, columns); none if the rows differ, or there is nothing."""
    columns = {len(row) for row in grid}
    return (len(grid), columns.pop()) if len(columns) == 1 and columns != {0} else None


_CHECKS: Mapping[type, Callable[[Any], None]] = {
    Drop: _check_drop,
    Pours: _check_pours,
    Risk: _check_risk,
    Motions: _check_motions,
    Evaluation: check_evaluation,
    TrialFile: check_trial,
    Views: check_views,
}
